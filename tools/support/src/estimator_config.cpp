#include "armcmc/support/estimator_config.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "armcmc/estimator.hpp"

namespace armcmc::support {
namespace {

constexpr double kMax = std::numeric_limits<double>::infinity();
// Positive, and far enough from zero that its square and its inverse are finite.
constexpr double kTiny = 1e-100;

template <typename Enum>
using Words = std::vector<std::pair<std::string, Enum>>;

template <typename Enum>
Enum ReadWord(StrictTable& table, std::string_view key, Enum fallback, const Words<Enum>& words) {
  std::vector<std::string> names;
  std::string fallback_name;
  for (const auto& [name, value] : words) {
    names.push_back(name);
    if (value == fallback) fallback_name = name;
  }
  const std::string chosen = table.Choice(key, fallback_name, names);
  for (const auto& [name, value] : words)
    if (name == chosen) return value;
  return fallback;
}

EstimatorSettings Builtin(StrictTable& model, const std::string& model_override) {
  const std::string of_file = model_override.empty() ? model.RequiredText("name") : model.Text("name", "");
  const std::string& name = model_override.empty() ? of_file : model_override;
  try {
    return BuiltinSettings(name);
  } catch (const std::invalid_argument& error) {
    if (model_override.empty()) throw model.Error("name", error.what());
    throw ConfigError("--model " + name + ": " + error.what());
  }
}

void ReadParameters(StrictTable& model, EstimatorSettings* settings) {
  StrictTable parameters = model.Table("parameters");
  for (int i = 0; i < settings->num_parameters; ++i) {
    ParameterSettings& p = settings->parameters[static_cast<std::size_t>(i)];
    StrictTable table = parameters.Table(p.name);
    p.prior = ReadWord<PriorKind>(table, "prior", p.prior,
                                  {{"normal", PriorKind::kNormal}, {"uniform", PriorKind::kUniform}});
    p.mean = table.Number("mean", p.mean, -kMax, kMax);
    p.sd = table.Number("sd", p.sd, kTiny, kMax);
    p.lower = table.Number("lower", p.lower, -kMax, kMax);
    p.upper = table.Number("upper", p.upper, -kMax, kMax);
    if (!(p.lower < p.upper))
      throw table.Error(
          table.Has("upper") ? "upper" : "lower",
          "expected lower < upper, they are " + std::to_string(p.lower) + " and " + std::to_string(p.upper));
    if (p.prior == PriorKind::kUniform)
      for (const char* key : {"mean", "sd"})
        if (table.Has(key))
          throw table.Error(key, "a uniform prior has bounds only; remove this key or use prior = \"normal\"");
  }
}

void ReadNoise(StrictTable& table, NoiseSettings* noise) {
  noise->kind = ReadWord<NoiseKind>(table, "kind", noise->kind,
                                    {{"gaussian", NoiseKind::kGaussian},
                                     {"student_t", NoiseKind::kStudentT},
                                     {"laplace", NoiseKind::kLaplace},
                                     {"mixture", NoiseKind::kMixture}});
  noise->std = table.Number("std", noise->std, kTiny, kMax);
  noise->mean = table.Number("mean", noise->mean, -kMax, kMax);
  noise->estimate_std = table.Boolean("estimate_std", noise->estimate_std);
  noise->std_log_sd = table.Number("std_log_sd", noise->std_log_sd, kTiny, kMax);
  noise->dof = table.Number("dof", noise->dof, kTiny, kMax);
  noise->outlier_weight = table.Number("outlier_weight", noise->outlier_weight, kTiny, 0.5);
  noise->outlier_scale = table.Number("outlier_scale", noise->outlier_scale, std::nextafter(1.0, 2.0), kMax);
}

void ReadAllNoise(StrictTable& root, const std::vector<std::string>& modes, EstimatorSettings* settings) {
  StrictTable all = root.Table("noise");
  for (std::size_t mode = 0; mode < modes.size(); ++mode) {
    ReadNoise(all, &settings->noise[mode]);
    StrictTable one = all.Table(modes[mode]);
    ReadNoise(one, &settings->noise[mode]);
  }
}

void ReadForgetting(StrictTable table, ForgettingSettings* forgetting) {
  forgetting->index = ReadWord<MismatchIndex>(table, "index", forgetting->index,
                                              {{"rms", MismatchIndex::kRms},
                                               {"signed_mean", MismatchIndex::kSignedMean},
                                               {"log_predictive", MismatchIndex::kLogPredictive}});
  forgetting->threshold = table.Number("threshold", forgetting->threshold, kTiny, kMax);
  forgetting->mu = table.Number("mu", forgetting->mu, -kMax, kMax);
  forgetting->lambda_max = table.Number("lambda_max", forgetting->lambda_max, 0.0, 1.0);
  forgetting->rho = table.Number("rho", forgetting->rho, 0.0, 1.0);
  forgetting->min_samples = static_cast<int>(table.Integer("min_samples", forgetting->min_samples, 1, kMaxPackSamples));
}

void ReadSampler(StrictTable table, SamplerSettings* sampler) {
  sampler->epsilon = table.Number("epsilon", sampler->epsilon, 0.0, 1.0);
  sampler->delta = table.Number("delta", sampler->delta, 0.0, 1.0);
  if (table.IsText("draws") || !table.Has("draws")) {
    sampler->rule = ReadWord<DrawRule>(table, "draws", sampler->rule,
                                       {{"chernoff", DrawRule::kChernoff}, {"k_min", DrawRule::kKMin}});
  } else {
    sampler->rule = DrawRule::kFixed;
    sampler->fixed_draws =
        static_cast<int>(table.Integer("draws", sampler->fixed_draws, SamplerSettings::kMinDraws, kMaxDraws));
    // Who asks for a number of draws means to get it.
    sampler->max_draws = std::max(sampler->max_draws, sampler->fixed_draws);
  }
  sampler->max_draws =
      static_cast<int>(table.Integer("max_draws", sampler->max_draws, SamplerSettings::kMinDraws, kMaxDraws));
  sampler->lambda_q_min = table.Number("lambda_q_min", sampler->lambda_q_min, 0.0, 1.0);
  sampler->lambda_q_max = table.Number("lambda_q_max", sampler->lambda_q_max, 0.0, 1.0);
  constexpr auto kMaxSeed = std::numeric_limits<std::int64_t>::max();
  // A TOML integer has a sign; seeds of the upper half of the range come from --seed only.
  const bool fits = sampler->seed <= static_cast<std::uint64_t>(kMaxSeed);
  const std::int64_t fallback = fits ? static_cast<std::int64_t>(sampler->seed) : 0;
  const std::int64_t seed = table.Integer("seed", fallback, 0, kMaxSeed);
  if (table.Has("seed")) sampler->seed = static_cast<std::uint64_t>(seed);
}

void ReadConstants(StrictTable& model, PlantKind plant, EstimatorSettings* settings) {
  if (plant != PlantKind::kSoftActuator) {
    if (model.Has("constants")) throw model.Error("constants", settings->model + " has no constants");
    return;
  }
  StrictTable table = model.Table("constants");
  PlantConstants& c = settings->constants;
  c.p_atm = table.Number("p_atm", c.p_atm, 0.0, kMax);
  c.p_supply = table.Number("p_supply", c.p_supply, kTiny, kMax);
  c.q1 = table.Number("q1", c.q1, -kMax, kMax);
  c.q2 = table.Number("q2", c.q2, 0.0, kMax);
  c.q3 = table.Number("q3", c.q3, 0.0, kMax);
}

}  // namespace

EstimatorSettings ReadEstimatorSettings(StrictTable& root, const std::string& model_override) {
  root.RequiredInteger("schema", 1, 1);
  StrictTable model = root.Table("model");
  EstimatorSettings settings = Builtin(model, model_override);
  std::vector<std::string> modes;
  PlantKind plant{};
  {
    // The names of the modes belong to the model; an estimator with few draws is the way to ask for them.
    EstimatorSettings small = settings;
    small.sampler.rule = DrawRule::kFixed;
    small.sampler.fixed_draws = small.sampler.max_draws = SamplerSettings::kMinDraws;
    const Estimator probe(small);
    plant = probe.plant();
    for (int mode = 0; mode < probe.num_modes(); ++mode) modes.emplace_back(probe.mode_name(mode));
  }
  ReadParameters(model, &settings);
  ReadConstants(model, plant, &settings);
  ReadAllNoise(root, modes, &settings);
  ReadForgetting(root.Table("forgetting"), &settings.forgetting);
  ReadSampler(root.Table("sampler"), &settings.sampler);
  try {
    settings.Validate();
  } catch (const std::invalid_argument& error) {
    throw ConfigError(root.Name() + ": " + error.what());
  }
  return settings;
}

}  // namespace armcmc::support
