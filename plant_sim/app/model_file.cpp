#include "model_file.hpp"

#include <algorithm>
#include <armcmc/support/strict_toml.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/plant_sim/effects/effect.hpp"
#include "noise_table.hpp"

namespace armcmc::plant_sim {
namespace {

using support::ConfigError;
using support::StrictTable;
using Values = std::vector<double>;

constexpr double kMax = 1e12;

/// An effect of a model file in terms of the plant's.
struct ModelEffect {
  std::string name, variant;
  std::vector<std::string> amplitudes, shapes;  ///< Keys of the file.
  /// Parameters of the plant's effect from amplitudes and shapes; duration of the run in s.
  Values (*values)(const Values& amplitudes, const Values& shapes, double duration_s);
};

Values Same(const Values& amplitudes, const Values& shapes, double /*duration_s*/) {
  Values values = amplitudes;
  values.insert(values.end(), shapes.begin(), shapes.end());
  return values;
}

/// The plant gives a drift by what it comes to over the run.
Values OverTheRun(const Values& amplitudes, const Values& shapes, double duration_s) {
  return {amplitudes[0] * duration_s, shapes[0]};
}

Values AmplitudeOnly(const Values& amplitudes, const Values& /*shapes*/, double /*duration_s*/) { return amplitudes; }

/// a sin(w t + phase) = cosine cos(w t) + sine sin(w t).
Values Polar(const Values& amplitudes, const Values& shapes, double /*duration_s*/) {
  return {std::hypot(amplitudes[0], amplitudes[1]), shapes[0], std::atan2(amplitudes[0], amplitudes[1])};
}

const std::vector<ModelEffect>& ModelsOfContact() {
  static const std::vector<ModelEffect> effects = {
      {"force_bias", "constant", {"force"}, {}, Same},
      {"force_drift", "linear", {"rate"}, {"origin"}, OverTheRun},
      {"coulomb_friction", "tanh", {"force"}, {"speed"}, Same},
      {"presliding_friction", "dahl", {"force"}, {"distance"}, Same},
      {"viscous_friction", "linear", {"coefficient"}, {}, Same},
      {"inertia", "rigid", {"mass"}, {"smoothing"}, AmplitudeOnly},
      {"sensor_delay", "dead_time", {"time"}, {}, Same},
      {"sensor_lag", "first_order", {"time_constant"}, {}, Same},
      {"stress_relaxation", "linear", {"stiffness"}, {"time_constant"}, Same},
      {"adhesion", "exponential", {"force"}, {"distance"}, Same},
      {"contact_offset", "shift", {"distance"}, {}, Same},
      {"sensor_saturation", "clip", {"limit"}, {}, Same},
      {"periodic_disturbance", "sine", {"cosine", "sine"}, {"frequency"}, Polar},
      {"stiffness_drift", "linear", {"rate"}, {"origin"}, OverTheRun},
  };
  return effects;
}

/// In the order in which the estimator lets them act, which for the valves is that of the list.
const std::vector<ModelEffect>& ModelsOfActuator() {
  static const std::vector<ModelEffect> effects = {
      {"pressure_bias", "constant", {"bias"}, {}, Same},
      {"valve_lag", "spool", {"tau"}, {}, Same},
      {"valve_dead_band", "rescaled", {"width"}, {}, Same},
      {"supply_droop", "opening", {"droop"}, {}, Same},
      {"leak", "linear", {"rate"}, {}, Same},
  };
  return effects;
}

const std::vector<ModelEffect>& ModelEffects(const Scenario& scenario) {
  return scenario.family->name == "soft_actuator" ? ModelsOfActuator() : ModelsOfContact();
}

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
  const std::vector<ModelEffect>& known = ModelEffects(scenario);
  std::vector<std::string> names;
  for (const ModelEffect& effect : known) names.push_back(effect.name);
  const std::string name = table->RequiredChoice("name", names);
  const ModelEffect& model =
      *std::find_if(known.begin(), known.end(), [&name](const ModelEffect& effect) { return effect.name == name; });
  HiddenEffect effect;
  effect.spec = FindEffectSpec(*scenario.family, model.name, model.variant);
  effect.gate = ReadGate(table, scenario.family->name == "hunt_crossley");
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

}  // namespace

void ApplyModelFile(const std::filesystem::path& path, Scenario* scenario) {
  StrictTable root = StrictTable::FromFile(path);
  static_cast<void>(root.RequiredInteger("schema", 1, 1));
  const std::string base = root.RequiredText("base");
  const std::string family = base == "soft_actuator_excited" ? "soft_actuator" : base;
  if (family != "hunt_crossley" && family != "soft_actuator")
    throw root.Error("base", "\"" + base + "\" cannot become a plant: \"hunt_crossley\" and \"soft_actuator\" can");
  if (scenario->family->name != family)
    throw root.Error("base", "\"" + base + "\" does not fit the scenario's plant, \"" + scenario->family->name + "\"");
  if (!scenario->schedule.changes().empty())
    throw ConfigError(scenario->name +
                      " changes its parameters ([[change]]): a model file needs a scenario that does not");
  if (!scenario->hidden.empty())
    throw ConfigError(scenario->name +
                      " hides effects ([[hidden_effect]]): a model file needs a scenario that does not");
  root.LeaveToOthers("noise");
  Scenario changed = *scenario;
  if (family == "soft_actuator") {
    // One prior serves both valves: it says nothing on either.
    for (const char* estimated : {"parameters", "constants", "pressure_rate"}) root.LeaveToOthers(estimated);
  } else {
    changed.schedule = ReadParameters(root.Table("parameters"), *scenario);
  }
  for (StrictTable& table : root.Tables("effect")) {
    HiddenEffect effect = ReadEffect(&table, changed);
    for (const HiddenEffect& other : changed.hidden)
      if (other.spec == effect.spec) throw table.Error("name", effect.spec->name + " is there twice");
    changed.hidden.push_back(std::move(effect));
  }
  root.Finish();
  if (family == "soft_actuator") {
    const auto place = [](const HiddenEffect& effect) {
      return std::find_if(ModelsOfActuator().begin(), ModelsOfActuator().end(),
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
