#pragma once

#include <array>
#include <vector>

#include "armcmc/gap/effect_form.hpp"
#include "armcmc/gap/prediction.hpp"

namespace armcmc::gap {

/// Constants of a linear motion of one coordinate x:  x'' = gain u - damping x' - stiffness x.
struct MotionConstants {
  double gain = 0.0;       ///< Acceleration per input.
  double damping = 0.0;    ///< 1/s
  double stiffness = 0.0;  ///< 1/s^2
};

/// Free run of  x'' = gain u - damping x' - stiffness x + forces(x, x', t)  on the samples of a recording.
///
/// The linear part is exact for an input that is linear between samples; the forces are solved for at the end of each
/// step.
class DrivenMotion {
 public:
  DrivenMotion(const MotionConstants& constants, double dt);

  struct State {
    double angle = 0.0, rate = 0.0;  ///< x and x'.
  };
  /// A force with the values of its coordinates.
  struct Force {
    const EffectForm* form = nullptr;
    std::vector<double> values;
    const Vector* gate = nullptr;
  };

  /// @param input  u at every sample.
  /// @param rows   Rows to run; the rest of `angle` is left alone.
  /// @param rate   May be null.
  void Run(const Vector& t, const Vector& input, State start, const std::vector<Force>& forces, Eigen::Index rows,
           Vector* angle, Vector* rate) const;

  /// Runs that differ in their forces only, from the same start; column by run. They go through the samples together: a
  /// step of one waits for its tanh, and meanwhile the others' are at work.
  void RunInterleaved(const Vector& t, const Vector& input, State start, const std::vector<std::vector<Force>>& forces,
                      Matrix* angles) const;

  /// What an acceleration of each row adds to the angle, from rest.
  [[nodiscard]] Vector Response(const Vector& acceleration) const;

 private:
  struct Lane;
  void Advance(const Vector& t, const Vector& input, Eigen::Index rows, std::vector<Lane>* lanes) const;
  [[nodiscard]] Motion MotionOf(const Vector& t, const Vector& input, const State& state, Eigen::Index i) const;
  [[nodiscard]] double Added(const Lane& lane, const Vector& t, const Vector& input, const State& state,
                             Eigen::Index i) const;
  [[nodiscard]] State Moved(const State& x, double start, double end) const;

  MotionConstants constants_;
  double dt_;
  std::array<double, 4> step_;            ///< State to state.
  std::array<double, 2> first_, second_;  ///< Acceleration at the start and at the end of a step to state.
};

}  // namespace armcmc::gap
