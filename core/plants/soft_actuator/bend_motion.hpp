#pragma once

#include <array>

#include "armcmc/nonblocking.hpp"
#include "plants/soft_actuator/constants.hpp"

namespace armcmc {

/// The bending of the soft actuator from one sample to the next:
///
///   alpha'' = q1 (p - p_atm) - q2 alpha' - q3 alpha
///
/// by the exact transition of this linear equation for a pressure that is linear between samples.
class BendMotion {
 public:
  struct State {
    double angle = 0.0;  ///< alpha, rad
    double rate = 0.0;   ///< alpha', rad/s
  };

  explicit BendMotion(const ActuatorConstants& constants) noexcept : constants_(constants) {}

  /// Sample interval of the steps that follow, s > 0. @rt A fixed number of products of 4 x 4 matrices when it changes.
  void SetInterval(double dt) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] double interval() const noexcept { return dt_; }
  /// @param p0, p1  Pressure (Pa) at the start and the end of the step. @pre SetInterval().
  [[nodiscard]] State Next(const State& state, double p0, double p1) const noexcept ARMCMC_NONBLOCKING {
    const double start = p0 - constants_.p_atm, end = p1 - constants_.p_atm;
    return {transition_[0] * state.angle + transition_[1] * state.rate + gain_[0] * start + gain_[1] * end,
            transition_[2] * state.angle + transition_[3] * state.rate + gain_[2] * start + gain_[3] * end};
  }
  /// alpha'' (rad/s^2) of a state at a pressure (Pa).
  [[nodiscard]] double Acceleration(const State& state, double p) const noexcept ARMCMC_NONBLOCKING {
    return constants_.q1 * (p - constants_.p_atm) - constants_.q2 * state.rate - constants_.q3 * state.angle;
  }

 private:
  ActuatorConstants constants_;
  double dt_ = 0.0;
  std::array<double, 4> transition_{};  ///< exp(A dt), row major.
  std::array<double, 4> gain_{};        ///< Effect of p - p_atm at the start and the end of a step.
};

}  // namespace armcmc
