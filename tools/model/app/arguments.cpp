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
      "  armcmc-model check my_axis.toml --recording run.toml\n"
      "  armcmc-model check my_axis.toml --with coulomb_friction,sensor_delay\n"
      "  armcmc-model add my_axis.toml coulomb_friction --data run.csv --out my_axis_friction.toml\n"
      "Exit status: 0 ok, 2 bad usage or an invalid file; one line says where, and what was expected; 1 any other "
      "failure.");
  CLI::App* check = app->add_subcommand(
      "check", "Prints a plant file as it was parsed, the time of a step, and which parameters the data identify");
  check->add_option("PLANT", a->plant, "Plant file, or name of a bundled plant")->required();
  check->add_option("--with", a->with, "Effects to add first, comma separated: NAME, NAME:VARIANT or NAME:x=SYMBOL")
      ->type_name("NAME")
      ->delimiter(',');
  CLI::Option* data =
      check
          ->add_option(
              "--data,--recording", a->data,
              "Recording file, or CSV whose columns are t and the plant's signals: which parameters do they identify?")
          ->check(CLI::ExistingFile);
  check->add_option("--data-dir", a->data_dir, "Folder of the recording's CSV, if not that of the recording file")
      ->type_name("DIR")
      ->needs(data);
  check->add_flag("--skip-bad", a->skip_bad, "Skip bad rows of a CSV instead of stopping")->needs(data);
  check->add_flag("--effects", a->effects, "Also list which effects of the catalogue apply, and why others do not");
  app->add_subcommand("list", "Lists the bundled plants and effects");
  CLI::App* add = app->add_subcommand("add", "Writes a plant file with an effect of the catalogue added");
  add->add_option("PLANT", a->plant, "Plant file, or name of a bundled plant")->required();
  add->add_option("EFFECT", a->effect, "NAME, NAME:VARIANT or NAME:x=SYMBOL")->required();
  add->add_option("--data", a->data, "CSV whose columns are t and the plant's signals: sets the scale of the priors")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  add->add_option("--out", a->out, "Plant file to write")->type_name("FILE")->required();
  CLI::App* create = app->add_subcommand("new", "Writes NAME.toml, a commented plant file to start from");
  create->add_option("NAME", a->name, "Name of the plant: lower-case letters, digits and _")->required();
  create->add_option("--from", a->from, "Plant to start from, by name or by file")
      ->type_name("PLANT")
      ->capture_default_str();
}

}  // namespace armcmc::model
