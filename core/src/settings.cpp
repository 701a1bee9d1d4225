#include "armcmc/settings.hpp"

#include <cmath>
#include <span>
#include <sstream>
#include <stdexcept>

#include "armcmc/models/registry.hpp"
#include "armcmc/plant/program.hpp"
#include "armcmc/sample_size.hpp"

namespace armcmc {
namespace {

[[noreturn]] void Fail(const std::string& key, double value, const std::string& range) {
  std::ostringstream text;
  text << key << " = " << value << " is outside " << range;
  throw std::invalid_argument(text.str());
}

void Open(const std::string& key, double value, double lo, double hi) {
  if (!(value > lo && value < hi)) {
    std::ostringstream range;
    range << "(" << lo << ", " << hi << ")";
    Fail(key, value, range.str());
  }
}

void Closed(const std::string& key, double value, double lo, double hi) {
  if (!(value >= lo && value <= hi)) {
    std::ostringstream range;
    range << "[" << lo << ", " << hi << "]";
    Fail(key, value, range.str());
  }
}

void ValidateNoise(const std::string& key, const NoiseSettings& noise) {
  Open(key + ".std", noise.std, 0.0, HUGE_VAL);
  Open(key + ".mean", noise.mean, -HUGE_VAL, HUGE_VAL);
  Open(key + ".std_log_sd", noise.std_log_sd, 0.0, 10.0);
  Closed(key + ".dof", noise.dof, 1.0, 1000.0);
  Closed(key + ".outlier_weight", noise.outlier_weight, 1e-6, 0.5);
  Closed(key + ".outlier_scale", noise.outlier_scale, 1.0 + 1e-6, 1e4);
}

void ValidateParameter(const std::string& key, const ParameterSettings& p) {
  if (!(std::isfinite(p.lower) && std::isfinite(p.upper) && p.lower < p.upper))
    throw std::invalid_argument(key + ": lower must be below upper, both finite");
  if (p.prior == PriorKind::kUniform) return;
  Open(key + ".sd", p.sd, 0.0, HUGE_VAL);
  Open(key + ".mean", p.mean, -HUGE_VAL, HUGE_VAL);
  constexpr double kReach = 5.0;
  if (p.lower > p.mean + kReach * p.sd || p.upper < p.mean - kReach * p.sd)
    throw std::invalid_argument(key + ": the bounds hold none of the prior's mass (mean more than 5 sd outside)");
}

std::string KnownEffects(const ModelInfo& model) {
  std::string known;
  for (const EffectInfo* info : model.compiled->effects)
    if (info->online) known += (known.empty() ? "" : ", ") + std::string(info->name);
  return known;
}

/// `text` with the formula where it says {}.
std::string WithFormula(std::string_view text, const EffectInfo& info) {
  std::string filled(text);
  if (const std::size_t at = filled.find("{}"); at != std::string::npos) filled.replace(at, 2, info.formula);
  return filled;
}

void ValidateEffect(const EffectSettings& effect, const EffectInfo& info, const ModelInfo& model) {
  const std::string key = "effect." + effect.name;
  if (!info.online)
    throw std::invalid_argument(key + " is for offline fits only: " + WithFormula(model.compiled->offline_as, info) +
                                ". Remove it; those that run are " + KnownEffects(model));
  const std::string_view no_contact = model.compiled->no_contact_as;
  if (!no_contact.empty() && (effect.gate == EffectGate::kContact || effect.gate == EffectGate::kFree))
    throw std::invalid_argument(key + ": " + std::string(no_contact) + "; use when = \"always\", from_s or until_s");
  for (int i = 0; i < info.num_shapes; ++i) {
    const EffectShape& shape = info.shapes[static_cast<std::size_t>(i)];
    Closed(key + "." + std::string(shape.name), effect.shapes[static_cast<std::size_t>(i)], shape.lower, shape.upper);
  }
  for (int i = 0; i < info.num_amplitudes; ++i) {
    const EffectAmplitude& amplitude = info.amplitudes[static_cast<std::size_t>(i)];
    const ParameterSettings& p = effect.amplitudes[static_cast<std::size_t>(i)];
    const std::string name = key + "." + std::string(amplitude.name);
    if (p.name != amplitude.name)
      throw std::invalid_argument(name + ": in the settings this parameter is called '" + p.name + "'");
    ValidateParameter(name, p);
    if (amplitude.lower == 0.0) Closed(name + ".lower", p.lower, 0.0, HUGE_VAL);
  }
  if (effect.gate == EffectGate::kFrom) Open(key + ".from_s", effect.from_s, -HUGE_VAL, HUGE_VAL);
  if (effect.gate == EffectGate::kUntil) Open(key + ".until_s", effect.until_s, -HUGE_VAL, HUGE_VAL);
}

void ValidateEffects(const EstimatorSettings& s, const ModelInfo& model) {
  Closed("number of effects", s.num_effects, 0, kMaxEffects);
  if (s.num_effects == 0) return;
  int coordinates = model.num_parameters;
  bool samples_noise = false;
  for (std::size_t m = 0; m < static_cast<std::size_t>(model.num_modes); ++m)
    samples_noise = samples_noise || s.noise[m].estimate_std;
  coordinates += samples_noise ? 1 : 0;
  for (int e = 0; e < s.num_effects; ++e) {
    const EffectSettings& effect = s.effects[static_cast<std::size_t>(e)];
    const EffectInfo* info = FindEffect(model, effect.name);
    if (info == nullptr)
      throw std::invalid_argument("effect.name = '" + effect.name + "' is not an effect of " + s.model +
                                  "; known are " + KnownEffects(model));
    for (int other = 0; other < e; ++other)
      if (s.effects[static_cast<std::size_t>(other)].name == effect.name)
        throw std::invalid_argument("effect '" + effect.name + "' is named twice");
    ValidateEffect(effect, *info, model);
    coordinates += info->num_amplitudes;
  }
  if (coordinates > kMaxParams)
    throw std::invalid_argument("the model with its effects has " + std::to_string(coordinates) +
                                " parameters to sample (noise scale included), at most " + std::to_string(kMaxParams) +
                                " are possible: remove an effect or fix the noise scale");
}

void ValidateConstants(const EstimatorSettings& s, std::span<const ConstantInfo> constants) {
  for (std::size_t i = 0; i < constants.size(); ++i) {
    const ConstantInfo& c = constants[i];
    const std::string key = "constants." + std::string(c.name);
    Closed(key, s.constants[i], c.least, c.most);
    if (!c.above.empty()) Open(key, s.constants[i], ConstantOf(s, c.above), HUGE_VAL);
  }
}

EstimatorSettings DefaultsOf(const ModelInfo& info) {
  EstimatorSettings s;
  s.model = info.name;
  s.num_parameters = info.num_parameters;
  for (int d = 0; d < info.num_parameters; ++d) {
    const auto i = static_cast<std::size_t>(d);
    const ParameterInfo& p = info.parameters[i];
    s.parameters[i] = {std::string(p.name), PriorKind::kNormal, p.mean, p.sd, p.lower, p.upper};
  }
  for (auto& noise : s.noise) noise.std = info.default_noise_std;
  const std::span<const ConstantInfo> constants = info.compiled->constants;
  for (std::size_t i = 0; i < constants.size(); ++i) s.constants[i] = constants[i].value;
  return s;
}

}  // namespace

EffectSettings MakeEffect(const ModelInfo& model, const std::string& name, const EffectScales& scales) {
  const EffectInfo* found = FindEffect(model, name);
  if (found == nullptr) throw std::invalid_argument("unknown effect '" + name + "'; known are " + KnownEffects(model));
  const EffectInfo& info = *found;
  EffectSettings effect;
  effect.name = name;
  for (std::size_t i = 0; i < static_cast<std::size_t>(info.num_amplitudes); ++i) {
    const EffectAmplitude& a = info.amplitudes[i];
    const double unit = a.unit_size(scales);
    effect.amplitudes[i] = {std::string(a.name), PriorKind::kNormal, a.mean * unit,
                            a.sd * unit,         a.lower * unit,     a.upper * unit};
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(info.num_shapes); ++i)
    effect.shapes[i] = info.shapes[i].typical * info.shapes[i].unit_size(scales);
  return effect;
}

double ConstantOf(const EstimatorSettings& settings, std::string_view name) noexcept {
  const int model = FindModel(settings.model);
  if (model < 0 || settings.plant != nullptr) return std::nan("");
  const std::span<const ConstantInfo> constants =
      CompiledModels()[static_cast<std::size_t>(model)]->compiled->constants;
  for (std::size_t i = 0; i < constants.size(); ++i)
    if (constants[i].name == name) return settings.constants[i];
  return std::nan("");
}

void EstimatorSettings::Validate() const {
  const int index = FindModel(model);
  if (index < 0 && plant == nullptr)
    throw std::invalid_argument("model.name = '" + model + "' is not a built-in model");
  const ModelInfo& info = plant != nullptr ? plant->info() : *CompiledModels()[static_cast<std::size_t>(index)];
  if (plant != nullptr && num_effects > 0)
    throw std::invalid_argument("model '" + model + "' takes no effects of the built-in catalogue");
  if (num_parameters != info.num_parameters)
    throw std::invalid_argument("model '" + model + "' has " + std::to_string(info.num_parameters) +
                                " parameters, settings have " + std::to_string(num_parameters));
  for (int d = 0; d < num_parameters; ++d) {
    const auto i = static_cast<std::size_t>(d);
    if (parameters[i].name != info.parameters[i].name)
      throw std::invalid_argument("parameter " + std::to_string(d) + " is called '" + parameters[i].name +
                                  "', expected '" + std::string(info.parameters[i].name) + "'");
    ValidateParameter("parameters." + parameters[i].name, parameters[i]);
  }
  ValidateEffects(*this, info);
  for (int m = 0; m < info.num_modes; ++m)
    ValidateNoise("noise." + std::string(info.modes[static_cast<std::size_t>(m)]), noise[static_cast<std::size_t>(m)]);
  Open("forgetting.threshold", forgetting.threshold, 0.0, HUGE_VAL);
  Open("forgetting.mu", forgetting.mu, -HUGE_VAL, HUGE_VAL);
  Open("forgetting.lambda_max", forgetting.lambda_max, 0.0, 1.0);
  Closed("forgetting.rho", forgetting.rho, 0.0, 1.0);
  Closed("forgetting.min_samples", forgetting.min_samples, 1, kMaxPackSamples);
  if (!(forgetting.drift_share >= 0.0 && forgetting.drift_share < 1.0))
    Fail("forgetting.drift_share", forgetting.drift_share, "[0, 1)");
  Open("sampler.epsilon", sampler.epsilon, 0.0, 1.0);
  Open("sampler.delta", sampler.delta, 0.0, 1.0);
  Closed("sampler.max_draws", sampler.max_draws, SamplerSettings::kMinDraws, kMaxDraws);
  if (sampler.rule == DrawRule::kFixed)
    Closed("sampler.draws", sampler.fixed_draws, SamplerSettings::kMinDraws, sampler.max_draws);
  Open("sampler.lambda_q_min", sampler.lambda_q_min, 0.0, 1.0);
  Open("sampler.lambda_q_max", sampler.lambda_q_max, 0.0, 1.0);
  if (sampler.lambda_q_min > sampler.lambda_q_max)
    throw std::invalid_argument("sampler.lambda_q_min is above sampler.lambda_q_max");
  Open("baseline.rls_forgetting", baseline.rls_forgetting, 0.0, 1.0 + 1e-15);
  if (method == Method::kParticleFilter)
    Closed("baseline.particles", baseline.particles, SamplerSettings::kMinDraws, sampler.max_draws);
  Closed("baseline.pf_updates", baseline.pf_updates, 1, kMaxPackSamples);
  Closed("baseline.pf_jitter", baseline.pf_jitter, 0.0, 1.0);
  if (regress_rate && (info.compiled == nullptr || info.compiled->rate_unit.empty()))
    throw std::invalid_argument("model.regress_rate: '" + model + "' has no rate to regress; remove it");
  if (num_effects > 0 && (method == Method::kRls || (method == Method::kParticleFilter && baseline.pf_updates > 1)))
    throw std::invalid_argument("this method takes no effects: remove them or choose method = \"armcmc\"");
  Closed("timing.overlap", overlap, 1, kMaxPackSamples);
  Open("gap_watch.false_alarm_rate", gap_watch.false_alarm_rate, 0.0, 1.0);
  Closed("gap_watch.tolerance", gap_watch.tolerance, 0.0, 1.0);
  if (info.compiled != nullptr) ValidateConstants(*this, info.compiled->constants);
}

EstimatorSettings DescribedSettings(std::shared_ptr<const PlantProgram> plant) {
  EstimatorSettings s;
  const ModelInfo& info = plant->info();
  s.model = info.name;
  s.num_parameters = info.num_parameters;
  for (std::size_t d = 0; d < plant->sampled().size(); ++d) {
    const ParameterDescription& p = plant->sampled()[d];
    ParameterSettings& prior = s.parameters[d];
    prior = {p.name, p.prior == "uniform" ? PriorKind::kUniform : PriorKind::kNormal, p.mean, p.sd, *p.lower, *p.upper};
    if (p.prior != "lognormal") continue;
    constexpr double kReach = 8.0;  // a bound of 0 is beyond any
    prior.mean = std::log(p.mean);
    prior.lower = std::fmax(std::log(*p.lower), prior.mean - kReach * p.sd);
    prior.upper = std::log(*p.upper);
  }
  const NoiseDescription& described = plant->plant().description().noise;
  for (NoiseSettings& noise : s.noise) {
    noise.kind = described.law == "student_t" ? NoiseKind::kStudentT
                 : described.law == "laplace" ? NoiseKind::kLaplace
                 : described.law == "mixture" ? NoiseKind::kMixture
                                              : NoiseKind::kGaussian;
    noise.std = described.std;
    noise.estimate_std = described.estimate;
  }
  s.plant = std::move(plant);
  return s;
}

EstimatorSettings BuiltinSettings(const std::string& model) {
  for (const ModelInfo* info : CompiledModels()) {
    if (info->name == model) return DefaultsOf(*info);
    for (const ModelVariant& variant : info->compiled->variants) {
      if (variant.name != model) continue;
      EstimatorSettings settings = DefaultsOf(*info);
      variant.apply(&settings);
      return settings;
    }
  }
  throw std::invalid_argument("unknown model '" + model + "'; built-in models are " + ModelNames());
}

}  // namespace armcmc
