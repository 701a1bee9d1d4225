#include "arguments.hpp"

#include <CLI/CLI.hpp>

namespace armcmc::model {

void Declare(CLI::App* app, Arguments* a) {
  app->require_subcommand(1);
  app->footer(
      "Examples:\n"
      "  armcmc-model list\n"
      "  armcmc-model new my_axis --from servo_axis\n"
      "  armcmc-model check my_axis.toml\n"
      "Exit status: 0 ok, 2 the file is wrong, with one line that says where and what was expected.");
  CLI::App* check = app->add_subcommand("check", "Says what was understood of a plant file, in tables");
  check->add_option("PLANT", a->plant, "Plant file, or name of a plant that came along")->required();
  app->add_subcommand("list", "Lists the plants that came along");
  CLI::App* create = app->add_subcommand("new", "Writes NAME.toml, a commented plant file to start from");
  create->add_option("NAME", a->name, "Name of the plant: small letters, digits and _")->required();
  create->add_option("--from", a->from, "Plant to start from, by name or by file")->capture_default_str();
}

}  // namespace armcmc::model
