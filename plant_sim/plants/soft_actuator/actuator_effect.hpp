#pragma once

#include "armcmc/plant_sim/effects/effect.hpp"
#include "soft_actuator/valve_controller.hpp"

namespace armcmc::plant_sim {

/// The soft actuator's state where an effect acts.
struct ActuatorState {
  double t_s, angle, angle_rate;  ///< s, rad, rad/s.
  double gauge_pressure;          ///< Pa above the atmosphere.
};

/// An effect inside the soft actuator's equations. Each hook defaults to no effect. @rt No heap, no lock, no throw.
class ActuatorEffect : public InnerEffect {
 public:
  /// Once a sample, before the openings are used: what the valves do when commanded so.
  [[nodiscard]] virtual ValveOpening Valve(const ValveOpening& command) noexcept { return command; }
  /// Once a sample, for effects with a memory of the motion.
  virtual void Step(const ActuatorState& /*state*/) noexcept {}
  /// Supply pressure (Pa) behind a fill valve that is open so far.
  [[nodiscard]] virtual double Supply(double p_supply, double /*fill*/) const noexcept { return p_supply; }
  /// Pa/s beside the valve flow's.
  [[nodiscard]] virtual double PressureRate(const ActuatorState& /*state*/) const noexcept { return 0.0; }
  /// rad/s^2 beside those of the base equation, which gives `base`.
  [[nodiscard]] virtual double Bend(const ActuatorState& /*state*/, double /*base*/) const noexcept { return 0.0; }
};

}  // namespace armcmc::plant_sim
