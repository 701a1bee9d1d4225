#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <string>

#include "arguments.hpp"
#include "armcmc/support/effect_library.hpp"
#include "armcmc/support/plant_file.hpp"
#include "armcmc/support/plant_library.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/text_table.hpp"
#include "compose.hpp"
#include "effect_tables.hpp"
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

/// The same with effects of the catalogue in it, or with what the catalogue has for it.
int CheckEffects(const Arguments& arguments) {
  const support::PlantFile file = support::ReadPlantFile(support::FindPlantFile(arguments.plant));
  const PlantDescription composed = Composed(file, arguments.with, std::nullopt);
  std::cout << PlantText(Plant(composed));
  if (arguments.effects) std::cout << '\n' << FittingText(composed, support::EffectsFor(file.effects));
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
  std::cout << table.ToString() << '\n' << EffectsText(support::ReadEffectLibrary());
  return support::kExitOk;
}

int Add(const Arguments& a) {
  std::cout << AddToFile(a.plant, a.effect,
                         a.data.empty() ? std::nullopt : std::optional<std::filesystem::path>(a.data), a.out);
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
    if (app.got_subcommand("add")) return model::Add(arguments);
    if (app.got_subcommand("check") && (arguments.effects || !arguments.with.empty()))
      return model::CheckEffects(arguments);
    if (app.got_subcommand("check")) return model::Check(arguments.plant);
    return app.got_subcommand("list") ? model::List() : model::New(arguments.name, arguments.from);
  });
}
