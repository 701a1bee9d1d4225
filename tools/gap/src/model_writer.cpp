#include "armcmc/gap/model_writer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "armcmc/gap/equation.hpp"
#include "armcmc/models/registry.hpp"

namespace armcmc::gap {
namespace {

constexpr double kWidenSd = 5.0;     // posterior standard deviations
constexpr double kLeastShare = 0.1;  // of the value
constexpr double kBoundSds = 10.0;
constexpr double kUsefulNoiseShare = 0.3;  // of the force noise, that a differentiated velocity may add

ParameterSettings Prior(const std::string& name, double mean, double sd, double lower) {
  const double wide = std::max({kWidenSd * sd, kLeastShare * std::abs(mean), 1e-9});
  return {name, PriorKind::kNormal, mean, wide, std::max(lower, mean - kBoundSds * wide), mean + kBoundSds * wide};
}

EffectGate GateOf(const When& when) {
  switch (when.kind) {
    case When::Kind::kContact: return EffectGate::kContact;
    case When::Kind::kFree: return EffectGate::kFree;
    case When::Kind::kFrom: return EffectGate::kFrom;
    case When::Kind::kUntil: return EffectGate::kUntil;
    case When::Kind::kAlways: break;
  }
  return EffectGate::kAlways;
}

/// Time constant that keeps the noise of a differentiated velocity below that of the force, or the longest allowed.
double InertiaSmoothing(const Signals& s, double mass, double noise_sd, double longest) {
  const double added = mass * s.velocity_noise * std::sqrt(2.0) / s.dt;
  const double ratio = added / (kUsefulNoiseShare * noise_sd);
  // A first-order low pass of n samples divides the noise of a difference by about sqrt(2) n.
  return ratio > 1.0 ? std::min(ratio * s.dt / std::sqrt(2.0), longest) : 0.0;
}

}  // namespace

void Equation::SetPriors(const std::vector<ParameterEstimate>& base, EstimatorSettings* settings) const {
  for (std::size_t i = 0; i < base.size(); ++i) {
    ParameterSettings& prior = settings->parameters[i];
    const double lower = prior.lower;
    prior = Prior(prior.name, base[i].mean, base[i].sd, std::min(lower, base[i].mean - base[i].sd));
  }
}

EstimatorSettings AugmentedSettings(const std::string& model, const Fitter& fitter, const Fitted& fitted,
                                    double noise_sd) {
  const Signals& signals = fitter.signals();
  EstimatorSettings settings = BuiltinSettings(model);
  const ModelInfo& plant = *CompiledModels()[static_cast<std::size_t>(FindModel(settings.model))];
  const Matrix covariance = fitted.Covariance(fitter.whitener().variance);
  if (signals.law_seen)
    fitter.equation().SetPriors(fitter.equation().Report(signals, fitted.theta, covariance), &settings);
  for (NoiseSettings& noise : settings.noise) {
    noise.kind = NoiseKind::kGaussian;
    noise.std = noise_sd;
  }
  if (fitted.hypothesis.terms.size() > kMaxEffects) throw std::invalid_argument("too many effects for the estimator");
  int num_terms = 0;
  for (const Term& term : fitted.hypothesis.terms) num_terms += term.form->size();
  Eigen::Index at = fitted.theta.size() - num_terms;
  for (const Term& term : fitted.hypothesis.terms) {
    const EffectForm& form = *term.form;
    if (!form.exact()) throw std::invalid_argument(form.effect + ": this formula cannot run in the estimator");
    EffectSettings effect = MakeEffect(plant, form.effect);
    effect.gate = GateOf(term.when);
    effect.from_s = effect.until_s = 0.0;
    if (effect.gate == EffectGate::kFrom) effect.from_s = term.when.time_s;
    if (effect.gate == EffectGate::kUntil) effect.until_s = term.when.time_s;
    const EffectInfo& info = *FindEffect(plant, form.effect);
    int written = 0;
    for (std::size_t c = 0; c < form.coordinates.size(); ++c) {
      const Coordinate& coordinate = form.coordinates[c];
      const Eigen::Index k = at + static_cast<Eigen::Index>(c);
      const double value = coordinate.Value(fitted.theta[k]);
      const double sd = std::abs(coordinate.Slope(fitted.theta[k])) * std::sqrt(std::max(covariance(k, k), 0.0));
      for (ParameterSettings& amplitude : effect.amplitudes) {
        if (amplitude.name != coordinate.name) continue;
        amplitude = Prior(coordinate.name, value, sd, amplitude.lower >= 0.0 ? 0.0 : -HUGE_VAL);
        ++written;
      }
      for (std::size_t s = 0; s < static_cast<std::size_t>(info.num_shapes); ++s)
        if (info.shapes[s].name == coordinate.name) effect.shapes[s] = value;
    }
    if (written != info.num_amplitudes)
      throw std::logic_error(form.effect + ": workflow and estimator name its amplitudes differently");
    if (form.effect == "force_drift" || form.effect == "stiffness_drift") effect.shapes[0] = signals.origin;
    if (form.effect == "inertia")
      effect.shapes[0] = InertiaSmoothing(signals, effect.amplitudes[0].mean, noise_sd, info.shapes[0].upper);
    settings.effects[static_cast<std::size_t>(settings.num_effects++)] = effect;
    at += form.size();
  }
  settings.Validate();
  return settings;
}

}  // namespace armcmc::gap
