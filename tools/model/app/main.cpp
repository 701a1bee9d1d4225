#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include "arguments.hpp"
#include "armcmc/support/plant_file.hpp"
#include "armcmc/support/plant_library.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/text_table.hpp"
#include "new_plant.hpp"
#include "plant_text.hpp"

namespace armcmc::model {
namespace {

int Check(const std::string& plant) {
  const std::filesystem::path path = support::FindPlantFile(plant);
  const Plant understood = support::ReadPlant(path);
  // What is more than the estimator can hold is an error of the file, with its place.
  if (MayRun(understood)) (void)support::ReadPlantProgram(path);
  std::cout << PlantText(understood);
  return support::kExitOk;
}

int List() {
  support::TextTable table({"plant", "signals", "parameters", "what it is"}, support::TextTable::Content::kWords);
  for (const std::string& name : support::PlantNames()) {
    const Plant plant = support::ReadPlant(support::FindPlantFile(name));
    std::string signals, parameters;
    for (const auto& signal : plant.description().signals) signals += (signals.empty() ? "" : " ") + signal.name;
    for (const auto& parameter : plant.description().parameters)
      parameters += (parameters.empty() ? "" : " ") + parameter.name;
    table.AddRow({name, signals, parameters, plant.description().title});
  }
  std::cout << table.ToString();
  return support::kExitOk;
}

int New(const std::string& name, const std::string& from) {
  const std::filesystem::path path = name + ".toml";
  const std::string text = NewPlantText(name, support::FindPlantFile(from));
  if (std::filesystem::exists(path)) throw support::InputError(path.string() + ": is there already");
  std::ofstream file(path, std::ios::binary);
  if (!(file << text) || !file.flush()) throw support::InputError(path.string() + ": cannot be written");
  std::cout << path.string() << ": a copy of " << from << " to change; then: armcmc-model check " << path.string()
            << '\n';
  return support::kExitOk;
}

}  // namespace
}  // namespace armcmc::model

int main(int argc, char** argv) {
  using namespace armcmc;
  CLI::App app{"Plants as files: what was understood of one, which ones came along, a start for a new one."};
  model::Arguments arguments;
  model::Declare(&app, &arguments);
  return support::RunProgram(app, "armcmc-model", argc, argv, [&] {
    if (app.got_subcommand("check")) return model::Check(arguments.plant);
    return app.got_subcommand("list") ? model::List() : model::New(arguments.name, arguments.from);
  });
}
