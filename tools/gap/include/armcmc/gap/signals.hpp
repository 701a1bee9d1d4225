#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

/// Physical meaning of a measured or derived quantity. Effects refer to roles, never to columns, so that one effect
/// serves every plant with the roles that it needs.
enum class Role : std::uint8_t {
  kPosition,      ///< Depth of a contact, angle of a joint: the coordinate of a spring.
  kVelocity,      ///< Its rate.
  kAcceleration,  ///< Its second derivative.
  kPressure,      ///< Of a chamber, above atmospheric.
  kOpening,       ///< Of a pair of valves: positive fills, negative vents.
  kCount,
};
inline constexpr std::size_t kNumRoles = static_cast<std::size_t>(Role::kCount);

/// One recording in the form that an equation uses: smoothed inputs by role, the measured output, the mode of every
/// sample.
///
/// Inputs are smoothed without phase shift: noise on an input adds noise to the prediction, and a delay or a low
/// pass would then fit better for the wrong reason.
struct Signals {
  double dt = 0.0;  ///< s
  Vector t;         ///< s
  Vector output;
  std::array<Vector, kNumRoles> input;    ///< Empty for roles that the plant does not have.
  std::array<double, kNumRoles> scale{};  ///< Root mean square of each input while the law acts.
  double output_scale = 1.0;              ///< Root mean square of the output while the law acts.
  double output_peak = 1.0;               ///< Largest output without outliers.
  int window = 1;                         ///< Samples of the smoother.
  double origin = 0.0;                    ///< Start time of effects that drift, s.
  double duration = 1.0;                  ///< Time in which they reach their amplitude, s.
  bool law_seen = true;                   ///< The law acts often enough for its parameters to be fitted.
  double smoothed_velocity_noise = 0.0;   ///< Standard deviation of the noise that remains in the velocity.
  double velocity_noise = 0.0;            ///< Standard deviation of the noise that smoothing removed from the velocity.
  Vector active;                          ///< 1 where the law acts (contact), 0 where it does not.

  [[nodiscard]] Eigen::Index rows() const { return t.size(); }
  [[nodiscard]] const Vector& at(Role role) const { return input[static_cast<std::size_t>(role)]; }
  [[nodiscard]] Vector& at(Role role) { return input[static_cast<std::size_t>(role)]; }
  [[nodiscard]] double scale_of(Role role) const { return scale[static_cast<std::size_t>(role)]; }
  /// Copies the units of fitted coordinates: scales, and the start time of drifts.
  void MeasureLike(const Signals& like) {
    origin = like.origin;
    duration = like.duration;
    scale = like.scale;
    output_scale = like.output_scale;
    output_peak = like.output_peak;
  }
  /// Time since the origin over the duration: in [0, 1] on the recording that was diagnosed.
  [[nodiscard]] Vector Elapsed() const { return ((t.array() - origin) / duration).matrix(); }
};

}  // namespace armcmc::gap
