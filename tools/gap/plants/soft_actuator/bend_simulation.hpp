#pragma once

#include <array>
#include <vector>

#include "armcmc/gap/effect_form.hpp"
#include "armcmc/gap/prediction.hpp"
#include "plants/soft_actuator/constants.hpp"

namespace armcmc::gap {

/// Free run of  alpha'' = q1 (p - p_atm) - q2 alpha' - q3 alpha + forces(alpha, alpha', t)  on the samples of a
/// recording.
///
/// The linear part is exact for a pressure that is linear between samples; the forces are
/// solved for at the end of each step.
class BendSimulation {
 public:
  BendSimulation(const ActuatorConstants& constants, double dt);

  struct State {
    double angle = 0.0, rate = 0.0;  ///< rad, rad/s
  };
  /// A force with the values of its coordinates.
  struct Force {
    const EffectForm* form = nullptr;
    std::vector<double> values;
    const Vector* gate = nullptr;
  };

  /// @param gauge  p - p_atm, Pa.
  /// @param rows   Rows to run; the rest of `angle` is left alone.
  /// @param rate   May be null.
  void Run(const Vector& t, const Vector& gauge, State start, const std::vector<Force>& forces, Eigen::Index rows,
           Vector* angle, Vector* rate) const;

  /// Runs that differ in their forces only, from the same start; column by run. They go through the samples together: a
  /// step of one waits for its tanh, and meanwhile the others' are at work.
  void RunInterleaved(const Vector& t, const Vector& gauge, State start, const std::vector<std::vector<Force>>& forces,
                      Matrix* angles) const;

  /// What an acceleration of each row adds to the angle, from rest.
  [[nodiscard]] Vector Response(const Vector& acceleration) const;

 private:
  struct Lane;
  void Advance(const Vector& t, const Vector& gauge, Eigen::Index rows, std::vector<Lane>* lanes) const;
  [[nodiscard]] Motion MotionOf(const Vector& t, const Vector& gauge, const State& state, Eigen::Index i) const;
  [[nodiscard]] double Added(const Lane& lane, const Vector& t, const Vector& gauge, const State& state,
                             Eigen::Index i) const;
  [[nodiscard]] State Moved(const State& x, double start, double end) const;

  ActuatorConstants constants_;
  double dt_;
  std::array<double, 4> step_;            ///< State to state.
  std::array<double, 2> first_, second_;  ///< Acceleration at the start and at the end of a step to state.
};

}  // namespace armcmc::gap
