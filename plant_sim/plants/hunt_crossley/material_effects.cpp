// The material and where it begins: its law, its memory, its surface, and the drive that presses into it.

#include <algorithm>
#include <cmath>

#include "hunt_crossley/effects.hpp"

namespace armcmc::plant_sim {
namespace {

using Values = std::vector<double>;

double Indentation(const EffectSignal& s) noexcept { return std::max(s.law.inputs[0], 0.0); }
/// K x^p of what the law is fed.
double ElasticForce(const EffectSignal& s) noexcept { return s.theta[0] * std::pow(Indentation(s), s.theta[2]); }

/// Maxwell branch, a spring in series with a damper: passes what changes, forgets what holds.
///   q' = u' - q / tau, solved for u linear over a step; starts relaxed.
class Maxwell {
 public:
  Maxwell(double tau, double dt) noexcept : decay_(std::exp(-dt / tau)), gain_(-tau / dt * std::expm1(-dt / tau)) {}
  double Step(double u) noexcept {
    if (!started_) last_ = u;
    started_ = true;
    q_ = decay_ * q_ + gain_ * (u - last_);
    last_ = u;
    return q_;
  }

 private:
  double decay_, gain_;
  double q_ = 0.0, last_ = 0.0;
  bool started_ = false;
};

}  // namespace

std::vector<EffectSpec> MaterialEffects() {
  using enum EffectScale;
  using enum FormulaKind;
  const EffectParameter share{"share", "-", kOne, 1e-5, 20.0};
  const EffectParameter tau{"tau", "s", kOne, 0.05, 1.5};
  const EffectParameter tension{"tension", "N", kForce, 1e-5, 10.0};
  const EffectParameter decay{"decay_length", "m", kDepth, 0.03, 0.3};
  return {
      {"stress_relaxation",
       "linear",
       kCatalogue,
       "f + stiffness q, q' = x+' - q / tau",
       EffectStage::kForce,
       false,
       {{"stiffness", "N/m", kForcePerDepth, 1e-5, 20.0}, tau},
       [](const Values& v, const EffectTiming& timing) {
         return MakeEffect([a = v[0], branch = Maxwell(v[1], timing.dt_s)](EffectSignal* s) mutable {
           s->seen.output += a * branch.Step(Indentation(*s));
         });
       }},
      {"stress_relaxation",
       "elastic",
       kVariant,
       "f + share q, q' = (K x^p)' - q / tau",
       EffectStage::kForce,
       false,
       {share, tau},
       [](const Values& v, const EffectTiming& timing) {
         return MakeEffect([a = v[0], branch = Maxwell(v[1], timing.dt_s)](EffectSignal* s) mutable {
           s->seen.output += a * branch.Step(ElasticForce(*s));
         });
       }},
      {"stress_relaxation",
       "two_time_constants",
       kVariant,
       "f + share (q1 + q2) / 2, qi' = (K x^p)' - qi / taui, tau2 = ratio tau",
       EffectStage::kForce,
       false,
       {share, {"tau", "s", kOne, 0.05, 0.3}, {"ratio", "-", kOne, 3.0, 10.0}},
       [](const Values& v, const EffectTiming& timing) {
         return MakeEffect([a = 0.5 * v[0], fast = Maxwell(v[1], timing.dt_s),
                            slow = Maxwell(v[2] * v[1], timing.dt_s)](EffectSignal* s) mutable {
           const double force = ElasticForce(*s);
           const double q = fast.Step(force) + slow.Step(force);
           s->seen.output += a * q;
         });
       }},
      {"adhesion",
       "exponential",
       kCatalogue,
       "f - tension exp(-x / decay_length) for x >= 0, v < 0",
       EffectStage::kForce,
       false,
       {tension, decay},
       [](const Values& p, const EffectTiming&) {
         return MakeEffect([a = p[0], d = p[1]](EffectSignal* s) {
           const double x = s->law.inputs[0];
           if (x >= 0.0 && s->law.inputs[1] < 0.0) s->seen.output -= a * std::exp(-x / d);
         });
       }},
      {"adhesion",
       "pull_off",
       kVariant,
       "f - tension n(x) while retracting, n = exp(-x / decay_length) inside, 1 + x / decay_length in the neck outside",
       EffectStage::kForce,
       false,
       {tension, decay},
       [](const Values& p, const EffectTiming&) {
         return MakeEffect([a = p[0], d = p[1], bonded = false](EffectSignal* s) mutable {
           const double x = s->law.inputs[0];
           if (x >= 0.0) bonded = true;
           if (x <= -d) bonded = false;  // The neck breaks; only a new contact bonds again.
           if (bonded && s->law.inputs[1] < 0.0) s->seen.output -= a * (x >= 0.0 ? std::exp(-x / d) : 1.0 + x / d);
         });
       }},
      {"contact_offset",
       "shift",
       kCatalogue,
       "law of x - offset",
       EffectStage::kInput,
       false,
       {{"offset", "m", kDepth, 1e-6, 0.6, true}},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([offset = v[0]](EffectSignal* s) { s->law.inputs[0] -= offset; });
       }},
      {"stiffness_drift",
       "linear",
       kCatalogue,
       "K max(1 + share (t - origin) / T, 0)",
       EffectStage::kParameters,
       false,
       {{"share", "-", kOne, 1e-5, 0.95, true}, {"origin", "s", kOne, 0.0, 0.0}},
       [](const Values& v, const EffectTiming& timing) {
         return MakeEffect([rate = v[0] / timing.duration_s, origin = v[1]](EffectSignal* s) {
           s->theta[0] *= std::max(1.0 + rate * (s->truth.t_s - origin), 0.0);
         });
       }},
      {"stiffness_drift",
       "exponential",
       kVariant,
       "K (1 + share (1 - exp(-t / tau)))",
       EffectStage::kParameters,
       false,
       {{"share", "-", kOne, 1e-5, 0.95, true}, {"tau", "s", kDuration, 0.1, 0.6}},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([share = v[0], tau = v[1]](EffectSignal* s) {
           s->theta[0] *= 1.0 - share * std::expm1(-s->truth.t_s / tau);
         });
       }},
      {"strain_stiffening",
       "exponential",
       kOutside,
       "K (1 + share (exp(x / length) - 1))",
       EffectStage::kParameters,
       false,
       {{"share", "-", kOne, 1e-5, 20.0}, {"length", "m", kDepth, 0.1, 0.3}},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([share = v[0], length = v[1]](EffectSignal* s) {
           s->theta[0] *= 1.0 + share * std::expm1(Indentation(*s) / length);
         });
       }},
      {"backlash",
       "play",
       kOutside,
       "law of y, which x drags along within +-half_gap",
       EffectStage::kInput,
       false,
       {{"half_gap", "m", kDepth, 1e-6, 0.6}},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([gap = v[0], y = 0.0, started = false](EffectSignal* s) mutable {
           const double x = s->law.inputs[0];
           // The drive has come from somewhere: it starts engaged, on the side that the motion pushes.
           if (!started) y = x - std::copysign(gap, s->law.inputs[1]);
           started = true;
           const bool engaged = std::abs(x - y) >= gap;
           y = std::clamp(y, x - gap, x + gap);
           s->law.inputs[0] = y;
           if (!engaged) s->law.inputs[1] = 0.0;
         });
       }},
  };
}

}  // namespace armcmc::plant_sim
