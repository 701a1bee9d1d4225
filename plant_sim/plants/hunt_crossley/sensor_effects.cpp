// The force sensor: what it does to the force before its noise.

#include <algorithm>
#include <cmath>

#include "armcmc/plant_sim/effects/delay_line.hpp"
#include "hunt_crossley/effects.hpp"

namespace armcmc::plant_sim {
namespace {

using Values = std::vector<double>;

/// tau y' + y = u, solved exactly for u linear over a step; starts settled.
class Lag {
 public:
  Lag(double tau, double dt) noexcept : tau_(tau), dt_(dt), decay_(std::exp(-dt / tau)) {}
  double Step(double u) noexcept {
    if (!started_) y_ = last_ = u;
    started_ = true;
    const double slope = (u - last_) / dt_;
    y_ = u - tau_ * slope + (y_ - last_ + tau_ * slope) * decay_;
    last_ = u;
    return y_;
  }

 private:
  double tau_, dt_, decay_;
  double y_ = 0.0, last_ = 0.0;
  bool started_ = false;
};

}  // namespace

std::vector<EffectSpec> SensorEffects() {
  using enum EffectScale;
  using enum FormulaKind;
  const EffectParameter delay{"delay", "s", kOne, 1e-6, 0.5};
  const EffectParameter tau{"tau", "s", kOne, 1e-5, 1.0};
  return {
      {"sensor_delay",
       "dead_time",
       kCatalogue,
       "f(t - delay)",
       EffectStage::kSensorDynamics,
       false,
       {delay},
       [](const Values& v, const EffectTiming& timing) {
         return MakeEffect([line = DelayLine(v[0], timing.dt_s)](EffectSignal* s) mutable {
           s->seen.output = line.Step(s->seen.output);
         });
       }},
      {"sensor_lag",
       "first_order",
       kCatalogue,
       "tau y' + y = f",
       EffectStage::kSensorDynamics,
       false,
       {tau},
       [](const Values& v, const EffectTiming& timing) {
         return MakeEffect(
             [lag = Lag(v[0], timing.dt_s)](EffectSignal* s) mutable { s->seen.output = lag.Step(s->seen.output); });
       }},
      {"sensor_lag",
       "second_order",
       kVariant,
       "tau^2 y'' + 2 tau y' + y = f",
       EffectStage::kSensorDynamics,
       false,
       {tau},
       [](const Values& v, const EffectTiming& timing) {
         return MakeEffect([first = Lag(v[0], timing.dt_s), second = Lag(v[0], timing.dt_s)](EffectSignal* s) mutable {
           s->seen.output = second.Step(first.Step(s->seen.output));
         });
       }},
      {"sensor_saturation",
       "clip",
       kCatalogue,
       "clip of f to +-limit",
       EffectStage::kSensorStatics,
       false,
       {{"limit", "N", kForcePeak, 1.0, 0.02}},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect(
             [limit = v[0]](EffectSignal* s) { s->seen.output = std::clamp(s->seen.output, -limit, limit); });
       }},
      {"dead_zone",
       "subtractive",
       kOutside,
       "sign(f) max(|f| - width, 0)",
       EffectStage::kSensorStatics,
       false,
       {{"width", "N", kForcePeak, 1e-6, 0.9}},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([width = v[0]](EffectSignal* s) {
           s->seen.output = std::copysign(std::max(std::abs(s->seen.output) - width, 0.0), s->seen.output);
         });
       }},
  };
}

}  // namespace armcmc::plant_sim
