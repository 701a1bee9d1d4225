#include "model_file.hpp"

#include <algorithm>
#include <armcmc/support/strict_toml.hpp>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/plant_sim/effects/effect.hpp"
#include "armcmc/plant_sim/effects/model_form.hpp"
#include "noise_table.hpp"

namespace armcmc::plant_sim {
namespace {

using support::ConfigError;
using support::StrictTable;
using Values = std::vector<double>;

constexpr double kMax = 1e12;

/// The mean of a prior or posterior; the rest of its table is the estimator's.
double Mean(StrictTable table) {
  if (table.Choice("prior", "normal", {"normal", "uniform"}) == "uniform")
    throw table.Error("prior", "a uniform prior has no mean, and a plant needs one value");
  const double lower = table.Number("lower", -kMax, -kMax, kMax);
  static_cast<void>(table.Number("sd", 1.0, 0.0, kMax));
  return table.RequiredNumber("mean", lower, table.Number("upper", kMax, lower, kMax));
}

Schedule ReadParameters(StrictTable table, const Scenario& scenario) {
  Values values;
  for (std::size_t i = 0; i < scenario.family->parameters.size(); ++i) {
    const ParameterSpec& spec = scenario.family->parameters[i];
    double value = scenario.schedule.Value(static_cast<int>(i), 0.0);
    if (table.Has(spec.name)) value = Mean(table.Table(spec.name));
    if (!(value >= spec.lo && value <= spec.hi))
      throw table.Error(spec.name, "the plant cannot be at " + std::to_string(value) + " " + spec.unit);
    values.push_back(value);
  }
  return {std::move(values), {}};
}

Gate ReadGate(StrictTable* table, bool has_contact) {
  const std::vector<std::string> whens =
      has_contact ? std::vector<std::string>{"always", "contact", "free"} : std::vector<std::string>{"always"};
  const std::string when = table->Choice("when", "always", whens);
  const bool from = table->Has("from_s"), until = table->Has("until_s");
  if (table->Has("when") + from + until > 1)
    throw table->Error(from ? "from_s" : "until_s", "an effect has `when`, `from_s` or `until_s`, not both");
  if (until) return {Gate::Kind::kUntil, table->RequiredNumber("until_s", -kMax, kMax)};
  if (!from) return Gate::Parse(when);
  const double from_s = table->RequiredNumber("from_s", -kMax, kMax);
  return from_s > 0.0 ? Gate{Gate::Kind::kFrom, from_s} : Gate{};
}

HiddenEffect ReadEffect(StrictTable* table, const Scenario& scenario) {
  const std::vector<ModelEffect>& known = scenario.family->model_form().effects;
  std::vector<std::string> names;
  names.reserve(known.size());
  for (const ModelEffect& effect : known) names.push_back(effect.name);
  const std::string name = table->RequiredChoice("name", names);
  const ModelEffect& model =
      *std::find_if(known.begin(), known.end(), [&name](const ModelEffect& effect) { return effect.name == name; });
  HiddenEffect effect;
  effect.spec = FindEffectSpec(*scenario.family, model.name, model.variant);
  effect.gate = ReadGate(table, scenario.family->makes_contact);
  Values amplitudes, shapes;
  for (const std::string& key : model.amplitudes) {
    if (!table->Has(key)) throw table->Error(key, "missing, and a plant needs its { mean = ... }");
    amplitudes.push_back(Mean(table->Table(key)));
  }
  for (const std::string& key : model.shapes) shapes.push_back(table->RequiredNumber(key, -kMax, kMax));
  effect.values = model.values(amplitudes, shapes, scenario.duration_s);
  for (std::size_t i = 0; i < effect.spec->parameters.size(); ++i) {
    // Delays, lengths and time constants divide or count samples; an amplitude of zero is no effect.
    const EffectParameter& parameter = effect.spec->parameters[i];
    const bool time_of_sensor = parameter.unit == "s" && i == 0;
    const bool positive = parameter.lo > 0.0 && !parameter.either_sign && (i > 0 || time_of_sensor);
    if (positive && !(effect.values[i] > 0.0))
      throw table->Error("name", name + " needs a positive " + parameter.name + ", it would be " +
                                     std::to_string(effect.values[i]) + " " + parameter.unit);
  }
  return effect;
}

/// The family that model files call by that name, or nullptr.
const PlantFamily* FamilyOf(const std::string& base) {
  for (const PlantFamily* family : PlantRegistry()) {
    if (family->model_form == nullptr) continue;
    const std::vector<std::string>& bases = family->model_form().bases;
    if (std::find(bases.begin(), bases.end(), base) != bases.end()) return family;
  }
  return nullptr;
}

/// "\"a\" and \"b\"".
std::string FamiliesWithForms() {
  std::string names;
  for (const PlantFamily* family : PlantRegistry())
    if (family->model_form != nullptr) names += (names.empty() ? "\"" : " and \"") + family->name + "\"";
  return names;
}

}  // namespace

void ApplyModelFile(const std::filesystem::path& path, Scenario* scenario) {
  StrictTable root = StrictTable::FromFile(path);
  root.RequireSchema();
  const std::string base = root.RequiredText("base");
  const PlantFamily* family = FamilyOf(base);
  if (family == nullptr)
    throw root.Error("base", "\"" + base + "\" cannot become a plant: " + FamiliesWithForms() + " can");
  if (scenario->family != family)
    throw root.Error("base", "\"" + base + "\" does not fit the scenario's plant, \"" + scenario->family->name + "\"");
  if (!scenario->schedule.changes().empty())
    throw ConfigError(scenario->name +
                      " changes its parameters ([[change]]): a model file needs a scenario that does not");
  if (!scenario->hidden.empty())
    throw ConfigError(scenario->name +
                      " hides effects ([[hidden_effect]]): a model file needs a scenario that does not");
  root.LeaveToOthers("noise");
  Scenario changed = *scenario;
  const ModelForm& form = family->model_form();
  for (const std::string& table : form.ignored) root.LeaveToOthers(table);
  if (std::find(form.ignored.begin(), form.ignored.end(), "parameters") == form.ignored.end())
    changed.schedule = ReadParameters(root.Table("parameters"), *scenario);
  for (StrictTable& table : root.Tables("effect")) {
    HiddenEffect effect = ReadEffect(&table, changed);
    for (const HiddenEffect& other : changed.hidden)
      if (other.spec == effect.spec) throw table.Error("name", effect.spec->name + " is listed twice");
    changed.hidden.push_back(std::move(effect));
  }
  root.Finish();
  if (form.in_this_order) {
    const auto place = [&form](const HiddenEffect& effect) {
      return std::find_if(form.effects.begin(), form.effects.end(),
                          [&](const ModelEffect& one) { return one.name == effect.spec->name; });
    };
    std::sort(changed.hidden.begin(), changed.hidden.end(),
              [&](const HiddenEffect& a, const HiddenEffect& b) { return place(a) < place(b); });
  }
  try {
    ResolveNoise(&changed);
  } catch (const std::invalid_argument& error) {
    throw ConfigError(path.string() + ": " + error.what());
  }
  *scenario = std::move(changed);
}

}  // namespace armcmc::plant_sim
