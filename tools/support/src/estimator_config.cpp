#include "armcmc/support/estimator_config.hpp"

#include <algorithm>
#include <stdexcept>

#include "armcmc/support/model_file.hpp"
#include "model_tables.hpp"
#include "read_word.hpp"

namespace armcmc::support {
namespace {

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
  forgetting->drift_share = table.Number("drift_share", forgetting->drift_share, 0.0, 1.0 - 1e-9);
  forgetting->partial_change = table.Boolean("partial_change", forgetting->partial_change);
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
  sampler->use_linearity = table.Boolean("use_linearity", sampler->use_linearity);
  constexpr auto kMaxSeed = std::numeric_limits<std::int64_t>::max();
  // A TOML integer has a sign; seeds of the upper half of the range come from --seed only.
  const bool fits = sampler->seed <= static_cast<std::uint64_t>(kMaxSeed);
  const std::int64_t fallback = fits ? static_cast<std::int64_t>(sampler->seed) : 0;
  const std::int64_t seed = table.Integer("seed", fallback, 0, kMaxSeed);
  if (table.Has("seed")) sampler->seed = static_cast<std::uint64_t>(seed);
}

void ReadMethod(StrictTable& root, EstimatorSettings* settings) {
  settings->method = ReadWord<Method>(root, "method", settings->method,
                                      {{"armcmc", Method::kArmcmc},
                                       {"rls", Method::kRls},
                                       {"pf", Method::kParticleFilter},
                                       {"mcmc", Method::kMetropolis}});
  // Whoever compares methods changes one key: the tuning of the others may stand in the same file.
  StrictTable table = root.Table("baseline");
  BaselineSettings& b = settings->baseline;
  b.recall = table.Boolean("recall", b.recall);
  b.rls_forgetting = table.Number("rls_forgetting", b.rls_forgetting, kTiny, 1.0);
  b.rls_reset = table.Boolean("rls_reset", b.rls_reset);
  b.particles = static_cast<int>(table.Integer("particles", b.particles, SamplerSettings::kMinDraws, kMaxDraws));
  b.pf_updates = static_cast<int>(table.Integer("pf_updates", b.pf_updates, 1, kMaxPackSamples));
  b.pf_jitter = table.Number("pf_jitter", b.pf_jitter, 0.0, 1.0);
}

void ReadGapWatch(StrictTable table, GapWatchSettings* watch) {
  watch->enabled = table.Boolean("enabled", watch->enabled);
  watch->false_alarm_rate = table.Number("false_alarm_rate", watch->false_alarm_rate, kTiny, 1.0 - 1e-9);
  watch->tolerance = table.Number("tolerance", watch->tolerance, 0.0, 1.0);
}

/// What a configuration may say of a plant that a file describes: the file has the priors, constants and effects.
void ReadDescribed(StrictTable& root, StrictTable& model, const ModelFacts& facts, EstimatorSettings* settings) {
  for (const char* key : {"parameters", "constants", "regress_rate", "pressure_rate"})
    if (model.Has(key)) throw model.Error(key, "stands in the plant's file, " + settings->model);
  if (root.Has("effect")) throw root.Error("effect", "the plant " + settings->model + " takes none");
  ReadNoise(root.Table("noise"), facts.modes, settings);
}

void ReadBuiltin(StrictTable& root, StrictTable& model, const ModelFacts& facts, EstimatorSettings* settings) {
  ReadParameters(model.Table("parameters"), settings);
  ReadConstants(model, *facts.model, settings);
  ReadRegressRate(model, *facts.model, settings);
  ReadNoise(root.Table("noise"), facts.modes, settings);
  ReadEffects(root, *facts.model, settings);
}

}  // namespace

EstimatorSettings ReadEstimatorSettings(StrictTable& root, const std::string& model_override) {
  root.RequireSchema();
  StrictTable model = root.Table("model");
  const std::string of_file = model.Text("name", "");
  const std::shared_ptr<const PlantProgram> plant = DescribedPlant(model_override.empty() ? of_file : model_override);
  EstimatorSettings settings = plant != nullptr
                                   ? DescribedSettings(plant)
                                   : Builtin(model, model_override.empty() ? "" : BaseModel(model_override));
  const ModelFacts facts = FactsOf(settings);
  (plant != nullptr ? ReadDescribed : ReadBuiltin)(root, model, facts, &settings);
  ReadMethod(root, &settings);
  ReadForgetting(root.Table("forgetting"), &settings.forgetting);
  ReadSampler(root.Table("sampler"), &settings.sampler);
  ReadGapWatch(root.Table("gap_watch"), &settings.gap_watch);
  settings.overlap = static_cast<int>(root.Table("timing").Integer("overlap", settings.overlap, 1, kMaxPackSamples));
  if (plant == nullptr && IsModelFile(model_override)) ApplyModelFile(model_override, &settings);
  try {
    settings.Validate();
  } catch (const std::invalid_argument& error) {
    throw ConfigError((IsModelFile(model_override) ? model_override : root.Name()) + ": " + error.what());
  }
  return settings;
}

}  // namespace armcmc::support
