#include "armcmc/support/plant_file.hpp"

#include <cctype>
#include <limits>

#include "armcmc/support/effect_request.hpp"
#include "description_tables.hpp"
#include "placed_error.hpp"

namespace armcmc::support {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

std::optional<double> OptionalNumber(StrictTable* table, std::string_view key) {
  if (!table->Has(key)) return std::nullopt;
  return table->RequiredNumber(key, -kInf, kInf);
}

void ReadSignals(StrictTable root, PlantDescription* plant) {
  StrictTable signals = root.Table("signals");
  for (const std::string& name : signals.Keys()) {
    StrictTable at = signals.Table(name);
    plant->signals.push_back({name, at.RequiredText("unit"), at.Text("role", ""), at.Text("derivative_of", ""),
                              at.Choice("between", "linear", {"linear", "held", "smooth"})});
  }
}

void ReadConstants(StrictTable root, PlantDescription* plant) {
  StrictTable constants = root.Table("constants");
  for (const std::string& name : constants.Keys()) {
    if (constants.IsTable(name)) {
      StrictTable at = constants.Table(name);
      plant->constants.push_back({name, at.RequiredNumber("value", -kInf, kInf), at.Text("unit", "")});
    } else {
      plant->constants.push_back({name, constants.RequiredNumber(name, -kInf, kInf), ""});
    }
  }
}

void ReadParameters(StrictTable root, PlantDescription* plant) {
  StrictTable parameters = root.Table("parameters");
  for (const std::string& name : parameters.Keys()) {
    StrictTable at = parameters.Table(name);
    ParameterDescription p;
    p.name = name;
    p.unit = at.RequiredText("unit");
    p.prior = at.Choice("prior", "normal", {"normal", "uniform", "lognormal"});
    if (p.prior == "uniform") {
      p.lower = at.RequiredNumber("lower", -kInf, kInf);
      p.upper = at.RequiredNumber("upper", -kInf, kInf);
    } else {
      p.mean = at.RequiredNumber("mean", -kInf, kInf);
      p.sd = at.RequiredNumber("sd", -kInf, kInf);
      p.lower = OptionalNumber(&at, "lower");
      p.upper = OptionalNumber(&at, "upper");
    }
    p.per_mode = at.Boolean("per_mode", false);
    plant->parameters.push_back(std::move(p));
  }
}

void ReadModes(StrictTable root, PlantDescription* plant) {
  for (StrictTable& at : root.Tables("mode")) {
    ModeDescription mode;
    mode.name = at.RequiredText("name");
    mode.when = at.Text("when", "");
    mode.passive = at.Boolean("passive", false);
    mode.law = at.Text("law", "");
    mode.target = at.Text("target", "");
    plant->modes.push_back(std::move(mode));
  }
}

void ReadStates(StrictTable root, PlantDescription* plant) {
  StrictTable states = root.Table("states");
  for (const std::string& name : states.Keys()) {
    StrictTable at = states.Table(name);
    StateDescription state = ReadState(&at, name);
    state.measured_by = at.Text("measured_by", "");
    plant->states.push_back(std::move(state));
  }
}

PlantDescription Describe(StrictTable root) {
  PlantDescription plant;
  root.RequireSchema();
  plant.name = root.RequiredText("name");
  plant.title = root.Text("title", plant.name);
  plant.output = root.RequiredText("output");
  plant.law = root.Text("law", "");
  plant.predicts = root.Text("predicts", "");
  ReadSignals(root, &plant);
  ReadConstants(root, &plant);
  ReadParameters(root, &plant);
  plant.lets = ReadLets(&root);
  ReadModes(root, &plant);
  ReadStates(root, &plant);
  StrictTable reports = root.Table("report");
  for (const std::string& name : reports.Keys()) {
    StrictTable at = reports.Table(name);
    plant.reports.push_back({name, at.RequiredText("unit"), at.RequiredText("value")});
  }
  StrictTable noise = root.Table("noise");
  plant.noise.law = noise.Choice("law", "gaussian", {"gaussian", "student_t", "laplace", "mixture"});
  plant.noise.std = noise.RequiredNumber("std", std::numeric_limits<double>::min(), kInf);
  plant.noise.estimate = noise.Boolean("estimate", false);
  root.Finish();
  return plant;
}

/// The plant as it stands in the file, and with the effects that the file uses.
PlantFile Interpreted(StrictTable root) {
  PlantEffects effects = ReadPlantEffects(root);
  PlantDescription description = Describe(root);
  PlantDescription used;
  std::vector<std::string> notes;
  try {
    Plant plant(std::move(description));
    for (const PlantNote& note : plant.notes())
      notes.emplace_back(PlacedError(root, PlantError(note.key, note.column, note.text)).what());
    if (effects.use.empty()) return {plant.description(), std::move(plant), std::move(effects), std::move(notes)};
    used = plant.description();
  } catch (const PlantError& error) {
    throw PlacedError(root, error);
  }
  PlantDescription base = used;
  try {
    used = WithEffects(std::move(used), EffectsFor(effects), effects.use, nullptr, "");
    return {std::move(base), Plant(std::move(used)), std::move(effects), std::move(notes)};
  } catch (const ConfigError& error) {
    throw root.Table("effects").Error("use", error.what());
  } catch (const PlantError& error) {
    throw root.Table("effects").Error("use", error.key() + ": " + error.what());
  }
}

}  // namespace

Plant ReadPlant(const std::filesystem::path& path) { return Interpreted(StrictTable::FromFile(path)).plant; }

PlantFile ReadPlantFile(const std::filesystem::path& path) { return Interpreted(StrictTable::FromFile(path)); }

std::shared_ptr<const PlantProgram> ReadPlantProgram(const std::filesystem::path& path) {
  const StrictTable root = StrictTable::FromFile(path);
  try {
    return std::make_shared<const PlantProgram>(std::make_shared<const Plant>(Interpreted(root).plant));
  } catch (const PlantError& error) {
    throw PlacedError(root, error);
  }
}

Plant PlantFromText(std::string_view text, std::string_view name) {
  return Interpreted(StrictTable::FromText(text, name)).plant;
}

}  // namespace armcmc::support
