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

  /// An effect that acts, at the rows of its gate.
  struct Force {
    const EffectForm* form = nullptr;
    const Vector* gate = nullptr;
  };
  struct Run {
    double angle = 0.0, rate = 0.0;           ///< x and x' at the first sample.
    std::vector<std::vector<double>> values;  ///< [force][coordinate]
  };

  /// x of every run: [row][run]. They go through the samples side by side: a step waits for what came before, and the
  /// work of one serves many.
  /// @param input  u at every sample.
  /// @param rows   To run, from the first.
  /// @param rate   x' of the first run, if not null.
  [[nodiscard]] Matrix Runs(const Vector& t, const Vector& input, const std::vector<Force>& forces,
                            const std::vector<Run>& runs, Eigen::Index rows, Vector* rate = nullptr) const;

  /// What an acceleration of each row adds to the angle, from rest.
  [[nodiscard]] Vector Response(const Vector& acceleration) const;

 private:
  class Step;

  MotionConstants constants_;
  double dt_;
  std::array<double, 4> step_;            ///< State to state.
  std::array<double, 2> first_, second_;  ///< Acceleration at the start and at the end of a step to state.
};

}  // namespace armcmc::gap
