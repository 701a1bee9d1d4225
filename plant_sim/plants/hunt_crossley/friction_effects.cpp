// Friction and drag of the mechanism that carries the needle. They act in contact and in free motion.

#include <cmath>

#include "hunt_crossley/effects.hpp"

namespace armcmc::plant_sim {
namespace {

using Values = std::vector<double>;

double Sign(double value) noexcept { return static_cast<double>((value > 0.0) - (value < 0.0)); }

/// Friction level of Stribeck (1902): `level` at speed, `1 + excess` times that at rest.
double Stribeck(double level, double excess, double v, double v_stribeck) noexcept {
  const double ratio = v / v_stribeck;
  return level * (1.0 + excess * std::exp(-ratio * ratio));
}

/// Mean deflection of the bristles that carry the friction (Dahl 1968; Canudas de Wit et al. 1995):
///   z' = v - |v| z / reach, solved exactly for v held over the step before a sample; z = 0 at the first.
class Bristle {
 public:
  void Step(double v, double reach, double dt) noexcept {
    if (!started_) {
      started_ = true;
      rate_ = v;
      return;
    }
    const double end = reach * Sign(v);
    const double decay = std::exp(-std::abs(v) / reach * dt);
    const double next = end + (z_ - end) * decay;
    rate_ = (next - z_) / dt;
    z_ = next;
  }
  [[nodiscard]] double z() const noexcept { return z_; }
  [[nodiscard]] double rate() const noexcept { return rate_; }

 private:
  double z_ = 0.0, rate_ = 0.0;
  bool started_ = false;
};

}  // namespace

std::vector<EffectSpec> FrictionEffects() {
  using enum EffectScale;
  using enum FormulaKind;
  const EffectParameter force{"force", "N", kForce, 1e-5, 10.0};
  const EffectParameter width{"v_s", "m/s", kSpeed, 0.01, 0.1};
  const EffectParameter reach{"x_s", "m", kDepth, 0.005, 0.1};
  const EffectParameter excess{"excess", "-", kOne, 0.2, 1.0};
  const EffectParameter v_stribeck{"v_stribeck", "m/s", kSpeed, 0.05, 0.4};
  return {
      {"coulomb_friction",
       "sign",
       kVariant,
       "f + force sign(v)",
       EffectStage::kForce,
       true,
       {force},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([f = v[0]](EffectSignal* s) { s->seen.output += f * Sign(s->truth.inputs[1]); });
       }},
      {"coulomb_friction",
       "tanh",
       kCatalogue,
       "f + force tanh(v / v_s)",
       EffectStage::kForce,
       true,
       {force, width},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect(
             [f = v[0], vs = v[1]](EffectSignal* s) { s->seen.output += f * std::tanh(s->truth.inputs[1] / vs); });
       }},
      {"coulomb_friction",
       "stribeck",
       kVariant,
       "f + force (1 + excess exp(-(v / v_stribeck)^2)) tanh(v / v_s)",
       EffectStage::kForce,
       true,
       {force, width, excess, v_stribeck},
       [](const Values& p, const EffectTiming&) {
         return MakeEffect([f = p[0], vs = p[1], excess = p[2], v_stribeck = p[3]](EffectSignal* s) {
           const double v = s->truth.inputs[1];
           s->seen.output += Stribeck(f, excess, v, v_stribeck) * std::tanh(v / vs);
         });
       }},
      {"presliding_friction",
       "dahl",
       kCatalogue,
       "f + force z / x_s, z' = v - |v| z / x_s",
       EffectStage::kForce,
       true,
       {force, reach},
       [](const Values& p, const EffectTiming& timing) {
         return MakeEffect([f = p[0], reach = p[1], dt = timing.dt_s, bristle = Bristle()](EffectSignal* s) mutable {
           bristle.Step(s->truth.inputs[1], reach, dt);
           s->seen.output += f * bristle.z() / reach;
         });
       }},
      {"presliding_friction",
       "lugre",
       kVariant,
       "f + force (z + tau z') / x_s, z' = v - |v| z / (x_s (1 + excess exp(-(v / v_stribeck)^2)))",
       EffectStage::kForce,
       true,
       {force, reach, excess, v_stribeck, {"tau", "s", kOne, 1e-3, 1e-2}},
       [](const Values& p, const EffectTiming& timing) {
         return MakeEffect([f = p[0], reach = p[1], excess = p[2], v_stribeck = p[3], tau = p[4], dt = timing.dt_s,
                            bristle = Bristle()](EffectSignal* s) mutable {
           const double v = s->truth.inputs[1];
           bristle.Step(v, Stribeck(reach, excess, v, v_stribeck), dt);
           s->seen.output += f * (bristle.z() + tau * bristle.rate()) / reach;
         });
       }},
      {"viscous_friction",
       "linear",
       kCatalogue,
       "f + damping v",
       EffectStage::kForce,
       true,
       {{"damping", "N s/m", kForcePerSpeed, 1e-5, 10.0}},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([c = v[0]](EffectSignal* s) { s->seen.output += c * s->truth.inputs[1]; });
       }},
      {"quadratic_drag",
       "quadratic",
       kOutside,
       "f + drag v |v|",
       EffectStage::kForce,
       false,
       {{"drag", "N s^2/m^2", kForcePerSpeedSq, 1e-5, 10.0}},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect(
             [c = v[0]](EffectSignal* s) { s->seen.output += c * s->truth.inputs[1] * std::abs(s->truth.inputs[1]); });
       }},
  };
}

}  // namespace armcmc::plant_sim
