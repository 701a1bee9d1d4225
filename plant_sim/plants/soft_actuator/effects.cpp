// The soft actuator: valves, supply, chamber, joint, and its sensors.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "armcmc/plant_sim/effects/delay_line.hpp"
#include "soft_actuator/actuator_effect.hpp"
#include "soft_actuator/effects.hpp"

namespace armcmc::plant_sim {
namespace {

using Values = std::vector<double>;

/// Angular acceleration from a function of state and base acceleration.
template <typename Function>
std::unique_ptr<InnerEffect> MakeBend(Function function) {
  class Of final : public ActuatorEffect {
   public:
    explicit Of(Function f) : f_(std::move(f)) {}
    [[nodiscard]] double Bend(const ActuatorState& state, double base) const noexcept override {
      return f_(state, base);
    }

   private:
    Function f_;
  };
  return std::make_unique<Of>(std::move(function));
}

class Leak final : public ActuatorEffect {
 public:
  explicit Leak(double rate) : rate_(rate) {}
  [[nodiscard]] double PressureRate(const ActuatorState& state) const noexcept override {
    return -rate_ * state.gauge_pressure;
  }

 private:
  double rate_;
};

class SupplyDroop final : public ActuatorEffect {
 public:
  explicit SupplyDroop(double droop) : droop_(droop) {}
  [[nodiscard]] double Supply(double p_supply, double fill) const noexcept override { return p_supply - droop_ * fill; }

 private:
  double droop_;
};

class ValveDeadBand final : public ActuatorEffect {
 public:
  explicit ValveDeadBand(double width) : width_(width) {}
  [[nodiscard]] ValveOpening Valve(const ValveOpening& command) noexcept override {
    const auto open = [this](double u) { return std::max(u - width_, 0.0) / (1.0 - width_); };
    return {open(command.fill), open(command.vent)};
  }

 private:
  double width_;
};

/// The pair of valves as one spool: its position, fill positive and vent negative, follows with one time constant.
class ValveLag final : public ActuatorEffect {
 public:
  ValveLag(double tau, double dt) : share_(-std::expm1(-dt / tau)) {}
  [[nodiscard]] ValveOpening Valve(const ValveOpening& command) noexcept override {
    position_ += share_ * (command.fill - command.vent - position_);
    return {std::max(position_, 0.0), std::max(-position_, 0.0)};
  }

 private:
  double share_, position_ = 0.0;
};

/// Bouc and Wen's z' = rate (1 - |z| (0.5 sign(z rate) + 0.5) / reach), one step a sample; |z| <= reach.
class BoucWen final : public ActuatorEffect {
 public:
  BoucWen(double acceleration, double reach, double dt) : a_(acceleration), reach_(reach), dt_(dt) {}
  void Step(const ActuatorState& state) noexcept override {
    const double travel = state.angle_rate * dt_;
    const double yielding = z_ * travel > 0.0 ? std::abs(z_) / reach_ : 0.0;
    z_ = std::clamp(z_ + travel * (1.0 - yielding), -reach_, reach_);
  }
  [[nodiscard]] double Bend(const ActuatorState& /*state*/, double /*base*/) const noexcept override {
    return -a_ * z_ / reach_;
  }

 private:
  double a_, reach_, dt_, z_ = 0.0;
};

EffectSpec Inner(std::string name, std::string variant, FormulaKind kind, std::string formula,
                 std::vector<EffectParameter> parameters,
                 std::unique_ptr<InnerEffect> (*make)(const Values& values, const EffectTiming& timing)) {
  EffectSpec spec;
  spec.name = std::move(name);
  spec.variant = std::move(variant);
  spec.kind = kind;
  spec.formula = std::move(formula);
  spec.parameters = std::move(parameters);
  spec.make_inner = make;
  return spec;
}

}  // namespace

std::vector<EffectSpec> ActuatorEffects() {
  using enum EffectScale;
  using enum FormulaKind;
  const EffectParameter acceleration{"acceleration", "rad/s^2", kOne, 1e-2, 2e4};
  return {
      Inner("leak", "linear", kCatalogue, "p' - rate (p - p_atm)", {{"rate", "1/s", kOne, 1e-5, 20.0}},
            [](const Values& v, const EffectTiming&) -> std::unique_ptr<InnerEffect> {
              return std::make_unique<Leak>(v[0]);
            }),
      Inner("valve_dead_band", "rescaled", kCatalogue, "u = max(u - width, 0) / (1 - width)",
            {{"width", "-", kOne, 1e-6, 0.08}},
            [](const Values& v, const EffectTiming&) -> std::unique_ptr<InnerEffect> {
              return std::make_unique<ValveDeadBand>(v[0]);
            }),
      Inner("valve_lag", "spool", kVariant, "tau s' + s = u_c - u_d, open to the side of s's sign",
            {{"tau", "s", kOne, 1e-5, 0.3}},
            [](const Values& v, const EffectTiming& timing) -> std::unique_ptr<InnerEffect> {
              return std::make_unique<ValveLag>(v[0], timing.dt_s);
            }),
      Inner("supply_droop", "opening", kVariant, "p_s - droop u_c", {{"droop", "Pa", kOne, 1e2, 6e6}},
            [](const Values& v, const EffectTiming&) -> std::unique_ptr<InnerEffect> {
              return std::make_unique<SupplyDroop>(v[0]);
            }),
      Inner("joint_friction", "tanh", kVariant, "alpha'' - acceleration tanh(alpha' / rate_s)",
            {acceleration, {"rate_s", "rad/s", kOne, 0.05, 0.3}},
            [](const Values& v, const EffectTiming&) {
              return MakeBend([a = v[0], s = v[1]](const ActuatorState& state, double) {
                return -a * std::tanh(state.angle_rate / s);
              });
            }),
      Inner("cubic_stiffness", "cubic", kCatalogue, "alpha'' - stiffness alpha^3",
            {{"stiffness", "1/(s rad)^2", kOne, 1e-2, 2e4}},
            [](const Values& v, const EffectTiming&) {
              return MakeBend([c = v[0]](const ActuatorState& state, double) {
                return -c * state.angle * state.angle * state.angle;
              });
            }),
      Inner("gravity_load", "sine", kCatalogue, "alpha'' - acceleration sin(alpha)", {acceleration},
            [](const Values& v, const EffectTiming&) {
              return MakeBend([a = v[0]](const ActuatorState& state, double) { return -a * std::sin(state.angle); });
            }),
      Inner("hysteresis", "bouc_wen", kCatalogue,
            "alpha'' - acceleration z / reach, z' = alpha' (1 - |z| / reach while loading)",
            {acceleration, {"reach", "rad", kOne, 0.02, 0.3}},
            [](const Values& v, const EffectTiming& timing) -> std::unique_ptr<InnerEffect> {
              return std::make_unique<BoucWen>(v[0], v[1], timing.dt_s);
            }),
      Inner("payload_step", "inertia", kCatalogue, "alpha'' / (1 + load) from t = at",
            {{"load", "-", kOne, 1e-4, 20.0}, {"at", "s", kDuration, 0.2, 0.8}},
            [](const Values& v, const EffectTiming&) {
              return MakeBend([share = v[0] / (1.0 + v[0]), at = v[1]](const ActuatorState& state, double base) {
                return state.t_s >= at ? -share * base : 0.0;
              });
            }),
      Inner("periodic_disturbance", "sine", kCatalogue, "alpha'' + acceleration sin(2 pi frequency t)",
            {acceleration, {"frequency", "Hz", kOne, 1.0, 20.0}},
            [](const Values& v, const EffectTiming&) {
              return MakeBend([a = v[0], omega = (2.0 * std::numbers::pi) * v[1]](const ActuatorState& state, double) {
                return a * std::sin(omega * state.t_s);
              });
            }),
      Inner("quadratic_drag", "quadratic", kOutside, "alpha'' - drag alpha' |alpha'|",
            {{"drag", "1/rad", kOne, 1e-3, 1e3}},
            [](const Values& v, const EffectTiming&) {
              return MakeBend([c = v[0]](const ActuatorState& state, double) {
                return -c * state.angle_rate * std::abs(state.angle_rate);
              });
            }),
      Inner("obstacle", "spring", kOutside, "alpha'' - stiffness max(alpha - angle, 0)",
            {{"stiffness", "1/s^2", kOne, 1e-1, 3e4}, {"angle", "rad", kOne, 0.5, 1.0}},
            [](const Values& v, const EffectTiming&) {
              return MakeBend([c = v[0], angle = v[1]](const ActuatorState& state, double) {
                return -c * std::max(state.angle - angle, 0.0);
              });
            }),
      {"pressure_bias",
       "constant",
       kCatalogue,
       "p + bias",
       EffectStage::kSensorStatics,
       false,
       {{"bias", "Pa", kOne, 1.0, 5e4, true}},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([bias = v[0]](EffectSignal* s) { s->seen.inputs[2] += bias; });
       }},
      {"angle_bias",
       "constant",
       kCatalogue,
       "alpha + bias",
       EffectStage::kSensorStatics,
       false,
       {{"bias", "rad", kOne, 1e-6, 1.0, true}},
       [](const Values& v, const EffectTiming&) {
         return MakeEffect([bias = v[0]](EffectSignal* s) { s->seen.output += bias; });
       }},
      {"sensor_delay",
       "dead_time",
       kCatalogue,
       "alpha(t - delay)",
       EffectStage::kSensorDynamics,
       false,
       {{"delay", "s", kOne, 1e-6, 0.3}},
       [](const Values& v, const EffectTiming& timing) {
         return MakeEffect([line = DelayLine(v[0], timing.dt_s)](EffectSignal* s) mutable {
           s->seen.output = line.Step(s->seen.output);
         });
       }},
  };
}

}  // namespace armcmc::plant_sim
