#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "arguments.hpp"
#include "armcmc/support/effect_library.hpp"
#include "armcmc/support/plant_file.hpp"
#include "armcmc/support/plant_library.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/recording.hpp"
#include "armcmc/support/text_table.hpp"
#include "compose.hpp"
#include "costs.hpp"
#include "effect_tables.hpp"
#include "identifiability.hpp"
#include "new_plant.hpp"
#include "plant_text.hpp"

namespace armcmc::model {
namespace {

/// Of a recording file, or of a CSV whose columns are the plant's signals; null without --data.
std::shared_ptr<const support::Recording> ReadData(const Arguments& a) {
  if (a.data.empty()) return nullptr;
  if (!a.data.ends_with(".toml"))
    return std::make_shared<const support::Recording>(
        support::ReadRecordedCsv(a.data, support::FindPlantFile(a.plant).string(), a.skip_bad));
  auto recording = std::make_shared<const support::Recording>(support::ReadRecording(a.data, a.data_dir));
  const Plant plant = support::ReadPlant(support::FindPlantFile(a.plant));
  if (recording->fingerprint != plant.fingerprint())
    throw support::InputError(a.data + ": has the signals of \"" + recording->plant + "\", not those of \"" +
                              plant.description().name + '"');
  return recording;
}

int Check(const Arguments& a) {
  const std::filesystem::path path = support::FindPlantFile(a.plant);
  const support::PlantFile file = support::ReadPlantFile(path);
  const auto plant =
      std::make_shared<const Plant>(a.with.empty() ? file.plant.description() : Composed(file, a.with, std::nullopt));
  // What is more than the estimator can hold is an error of the file, with its place. With effects PlantText says it.
  std::shared_ptr<const PlantProgram> program;
  try {
    program = a.with.empty() ? support::ReadPlantProgram(path) : std::make_shared<const PlantProgram>(plant);
  } catch (const PlantError&) {
  }
  const std::shared_ptr<const support::Recording> data = ReadData(a);
  std::cout << PlantText(*plant);
  for (const std::string& note : file.notes) std::cout << "note: " << note << '\n';
  if (a.effects) std::cout << '\n' << FittingText(plant->description(), support::EffectsFor(file.effects));
  if (program != nullptr) std::cout << CostText(program, data);
  if (program != nullptr && data != nullptr) std::cout << BetweenText(program, data);
  if (data == nullptr) return support::kExitOk;
  try {
    std::cout << '\n' << IdentifiabilityText(plant, *data);
  } catch (const PlantError& error) {
    std::cout << "which parameters these data identify cannot be determined: " << error.what() << '\n';
  }
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
  if (std::filesystem::exists(path)) throw support::InputError(path.string() + ": already exists");
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
  CLI::App app{"Checks, lists, creates and extends plant files."};
  model::Arguments arguments;
  model::Declare(&app, &arguments);
  return support::RunProgram(app, "armcmc-model", argc, argv, [&] {
    if (app.got_subcommand("add")) return model::Add(arguments);
    if (app.got_subcommand("check")) return model::Check(arguments);
    return app.got_subcommand("list") ? model::List() : model::New(arguments.name, arguments.from);
  });
}
