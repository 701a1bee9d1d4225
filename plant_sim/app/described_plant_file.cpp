#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "described_files.hpp"

namespace armcmc::plant_sim {
namespace {

using support::ConfigError;
using support::StrictTable;

constexpr double kAny = std::numeric_limits<double>::infinity();

double UsualValue(StrictTable* at, const std::string& prior) {
  const double lower = at->Number("lower", -kAny, -kAny, kAny), upper = at->Number("upper", kAny, -kAny, kAny);
  if (prior != "uniform") {
    static_cast<void>(at->RequiredNumber("sd", 0.0, kAny));
    return at->RequiredNumber("mean", -kAny, kAny);
  }
  if (!std::isfinite(lower) || !std::isfinite(upper)) throw at->Error("prior", "a uniform prior needs lower and upper");
  return (lower + upper) / 2.0;
}

void ReadNames(StrictTable root, DescribedPlant* plant) {
  StrictTable signals = root.Table("signals");
  for (const std::string& name : signals.Keys()) {
    StrictTable at = signals.Table(name);
    plant->signals.push_back({name, at.RequiredText("unit"), at.Text("role", ""), at.Text("derivative_of", ""),
                              at.Choice("between", "linear", {"linear", "held", "smooth"})});
  }
  StrictTable constants = root.Table("constants");
  for (const std::string& name : constants.Keys()) {
    if (!constants.IsTable(name)) {
      plant->constants.push_back({name, constants.RequiredNumber(name, -kAny, kAny)});
      continue;
    }
    StrictTable at = constants.Table(name);
    static_cast<void>(at.Text("unit", ""));
    plant->constants.push_back({name, at.RequiredNumber("value", -kAny, kAny)});
  }
  StrictTable parameters = root.Table("parameters");
  for (const std::string& name : parameters.Keys()) {
    StrictTable at = parameters.Table(name);
    static_cast<void>(at.RequiredText("unit"));
    const std::string prior = at.Choice("prior", "normal", {"normal", "uniform", "lognormal"});
    plant->parameters.push_back({name, UsualValue(&at, prior), at.Boolean("per_mode", false)});
  }
  StrictTable lets = root.Table("let");
  for (const std::string& name : lets.Keys()) plant->lets.push_back({name, lets.RequiredText(name)});
}

void ReadModes(StrictTable root, DescribedPlant* plant) {
  for (StrictTable& at : root.Tables("mode")) {
    DescribedPlant::Mode mode{at.RequiredText("name"), at.Text("when", ""), at.Text("law", ""), at.Text("target", ""),
                              at.Boolean("passive", false)};
    if (mode.law.empty() && !mode.passive) throw at.Error("law", "is missing; only a passive mode may be without");
    plant->modes.push_back(std::move(mode));
  }
  const std::string law = root.Text("law", "");
  if (plant->modes.empty() == law.empty())
    throw root.Error("law", law.empty() ? "is missing, and there is no [[mode]]" : "contradicts [[mode]]");
  plant->one_law = !law.empty();
  if (plant->one_law) plant->modes.push_back({"always", "", law, "", false});
}

void ReadStates(StrictTable root, DescribedPlant* plant) {
  constexpr std::int64_t kMostSubsteps = 100;
  StrictTable states = root.Table("states");
  for (const std::string& name : states.Keys()) {
    StrictTable at = states.Table(name);
    for (const char* word : {"unit", "role"}) static_cast<void>(at.Text(word, ""));
    plant->states.push_back({name, at.RequiredText("rate"), at.RequiredText("start"), at.Text("measured_by", ""),
                             static_cast<int>(at.Integer("substeps", 1, 1, kMostSubsteps))});
  }
}

}  // namespace

DescribedPlant ReadDescribedPlant(StrictTable root) {
  DescribedPlant plant;
  root.RequireSchema();
  plant.name = root.RequiredText("name");
  static_cast<void>(root.Text("title", ""));
  plant.output = root.RequiredText("output");
  plant.predicts = root.Text("predicts", "");
  ReadNames(root, &plant);
  ReadModes(root, &plant);
  ReadStates(root, &plant);
  StrictTable noise = root.Table("noise");
  plant.noise.kind = NoiseKind::kGaussian;
  const std::string law = noise.Choice("law", "gaussian", {"gaussian", "student_t", "laplace", "mixture"});
  for (const NoiseKind kind : {NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture})
    if (law == NoiseKindName(kind)) plant.noise.kind = kind;
  plant.noise.std = noise.RequiredNumber("std", 0.0, kAny);
  static_cast<void>(noise.Boolean("estimate", false));
  if (root.IsTable("effects")) static_cast<void>(root.Table("effects").Texts("without"));  // of a diagnosis
  if (root.IsTable("effects") && !root.Table("effects").TextsOrTables("use").empty())
    throw root.Table("effects").Error(
        "use", "the simulated plant has no catalogue of effects: write them as [[hidden]] into the scenario");
  for (const char* key : {"effects", "effect", "report"}) root.LeaveToOthers(key);
  root.Finish();
  return plant;
}

ConfigError Placed(const DescribedError& error, const StrictTable& plant, const StrictTable* scenario) {
  const std::string own = "scenario.";
  std::string path = error.key();
  const bool of_scenario = path.rfind(own, 0) == 0;
  if (of_scenario) path.erase(0, own.size());
  if (of_scenario && scenario == nullptr) return ConfigError(path + ": " + error.what());
  StrictTable table = of_scenario ? *scenario : plant;
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.')) {
    const std::string part = path.substr(0, dot);
    path.erase(0, dot + 1);
    if (const std::size_t bracket = part.find('['); bracket != std::string::npos) {
      table = table.Tables(part.substr(0, bracket)).at(std::stoul(part.substr(bracket + 1)));
    } else {
      if (table.Has(part) && !table.IsTable(part)) return table.Error(part, error.what());
      table = table.Table(part);
    }
  }
  return error.column() > 0 ? table.ErrorInText(path, error.column(), error.what()) : table.Error(path, error.what());
}

}  // namespace armcmc::plant_sim
