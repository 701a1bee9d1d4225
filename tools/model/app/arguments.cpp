#include "arguments.hpp"

#include <CLI/CLI.hpp>

namespace armcmc::model {

void Declare(CLI::App* app, Arguments* a) {
  app->require_subcommand(1);
  app->footer(
      "Examples:\n"
      "  armcmc-model list\n"
      "  armcmc-model new my_axis --from " ARMCMC_NEW_FROM
      "\n"
      "  armcmc-model check my_axis.toml\n"
      "  armcmc-model check my_axis.toml --data run.csv\n"
      "  armcmc-model check my_axis.toml --with coulomb_friction,sensor_delay\n"
      "  armcmc-model add my_axis.toml coulomb_friction --data run.csv --out my_axis_friction.toml\n"
      "Exit status: 0 ok, 2 the file is wrong, with one line that says where and what was expected.");
  CLI::App* check = app->add_subcommand(
      "check", "Says what was understood of a plant file, in tables; what it costs; which parameters data tell");
  check->add_option("PLANT", a->plant, "Plant file, or name of a plant that came along")->required();
  check->add_option("--with", a->with, "Effects to add first: NAME, NAME:VARIANT or NAME:x=SYMBOL, with commas between")
      ->delimiter(',');
  CLI::Option* data =
      check
          ->add_option(
              "--data", a->data,
              "Recording file, or CSV whose columns are t and the plant's signals: which parameters do they tell?")
          ->check(CLI::ExistingFile);
  check->add_option("--data-dir", a->data_dir, "Where the recording's CSV is if not beside its file")->needs(data);
  check->add_flag("--skip-bad", a->skip_bad, "Skip bad rows of a CSV instead of stopping")->needs(data);
  check->add_flag("--effects", a->effects, "Also says which effects of the catalogue fit, and why others do not");
  app->add_subcommand("list", "Lists the plants and the effects that came along");
  CLI::App* add = app->add_subcommand("add", "Writes a plant file that has an effect of the catalogue in it");
  add->add_option("PLANT", a->plant, "Plant file, or name of a plant that came along")->required();
  add->add_option("EFFECT", a->effect, "NAME, NAME:VARIANT or NAME:x=SYMBOL")->required();
  add->add_option("--data", a->data, "CSV whose columns are t and the plant's signals: gives the priors their size")
      ->check(CLI::ExistingFile);
  add->add_option("--out", a->out, "Plant file to write")->required();
  CLI::App* create = app->add_subcommand("new", "Writes NAME.toml, a commented plant file to start from");
  create->add_option("NAME", a->name, "Name of the plant: small letters, digits and _")->required();
  create->add_option("--from", a->from, "Plant to start from, by name or by file")->capture_default_str();
}

}  // namespace armcmc::model
