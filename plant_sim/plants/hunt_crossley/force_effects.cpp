// Forces beside the contact force, and what the force sensor adds by itself.

#include <cmath>
#include <numbers>

#include "hunt_crossley/effects.hpp"

namespace armcmc::plant_sim {
namespace {

using Values = std::vector<double>;

}  // namespace

std::vector<EffectSpec> ForceEffects() {
  using enum EffectScale;
  using enum FormulaKind;
  const EffectParameter force{"force", "N", kForce, 1e-5, 10.0, true};
  const EffectParameter amplitude{"amplitude", "N", kForce, 1e-5, 10.0};
  const EffectParameter frequency{"frequency", "Hz", kOne, 3.0, 60.0};
  const EffectParameter phase{"phase", "rad", kOne, 0.0, (2.0 * std::numbers::pi)};
  const EffectParameter origin{"origin", "s", kOne, 0.0, 0.0};  // Never drawn: what it does, a bias does, too.
  return {
      {"force_bias",
       "constant",
       kCatalogue,
       "f + force",
       EffectStage::kSensorStatics,
       false,
       {force},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([force = v[0]](EffectSignal* s) { s->seen.output += force; });
       }},
      {"force_drift",
       "linear",
       kCatalogue,
       "f + force (t - origin) / T",
       EffectStage::kSensorStatics,
       false,
       {force, origin},
       [](const Values& v, const EffectTiming& timing) {
         return MakeEffect([slope = v[0] / timing.duration_s, origin = v[1]](EffectSignal* s) {
           s->seen.output += slope * (s->truth.t_s - origin);
         });
       }},
      {"force_drift",
       "exponential",
       kVariant,
       "f + force (1 - exp(-t / tau))",
       EffectStage::kSensorStatics,
       false,
       {force, {"tau", "s", kDuration, 0.1, 0.6}},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([force = v[0], tau = v[1]](EffectSignal* s) {
           s->seen.output -= force * std::expm1(-s->truth.t_s / tau);
         });
       }},
      {"inertia",
       "rigid",
       kCatalogue,
       "f + mass x''",
       EffectStage::kForce,
       true,
       {{"mass", "kg", kForcePerAccel, 1e-5, 10.0}},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([mass = v[0]](EffectSignal* s) { s->seen.output += mass * s->acceleration; });
       }},
      {"periodic_disturbance",
       "sine",
       kCatalogue,
       "f + amplitude sin(2 pi frequency t + phase)",
       EffectStage::kForce,
       true,
       {amplitude, frequency, phase},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([a = v[0], omega = (2.0 * std::numbers::pi) * v[1], phase = v[2]](EffectSignal* s) {
           s->seen.output += a * std::sin(omega * s->truth.t_s + phase);
         });
       }},
      {"periodic_disturbance",
       "square",
       kVariant,
       "f + amplitude sign(sin(2 pi frequency t + phase))",
       EffectStage::kForce,
       true,
       {amplitude, frequency, phase},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([a = v[0], omega = (2.0 * std::numbers::pi) * v[1], phase = v[2]](EffectSignal* s) {
           s->seen.output += std::copysign(a, std::sin(omega * s->truth.t_s + phase));
         });
       }},
      {"spatial_ripple",
       "sine",
       kOutside,
       "f + amplitude sin(2 pi x / wavelength + phase) for x >= 0",
       EffectStage::kForce,
       false,
       {amplitude, {"wavelength", "m", kDepth, 0.05, 0.3}, phase},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([a = v[0], k = (2.0 * std::numbers::pi) / v[1], phase = v[2]](EffectSignal* s) {
           const double x = s->truth.inputs[0];
           if (x >= 0.0) s->seen.output += a * std::sin(k * x + phase);
         });
       }},
  };
}

}  // namespace armcmc::plant_sim
