#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "armcmc/types.hpp"

namespace armcmc {

inline constexpr int kMaxEffects = 5;           ///< Added to one model; the sampled coordinates bound them further.
inline constexpr int kMaxEffectAmplitudes = 2;  ///< Parameters of one effect that are estimated online.
inline constexpr int kMaxEffectShapes = 2;      ///< Parameters of one effect that are frozen.
inline constexpr int kEffectMemory = 2;         ///< Numbers that an effect may carry from sample to sample.

/// Where an effect acts. The order of the list is the order of evaluation, the same everywhere.
enum class EffectSlot : std::uint8_t {
  kInputMap,         ///< Changes what the constitutive law is given.
  kConstitutiveLaw,  ///< Changes a parameter of the law.
  kAdditive,         ///< Adds amplitude x feature to the force.
  kSensorDelay,      ///< Acts on the series of forces: dead time first,
  kSensorLag,        ///< then the low pass.
  kSensorStatics,    ///< Maps each force after that.
};

/// What an effect reads besides time.
struct EffectNeeds {
  bool position = false;
  bool velocity = false;
  bool acceleration = false;
  bool memory = false;    ///< Depends on the samples before.
  bool opening = false;   ///< Of the valves.
  bool pressure = false;  ///< In the chamber.
};

/// The sizes that make priors free of units: of a contact, rms force in contact, depth, speed and acceleration of the
/// motion; of a driven joint, rms pressure above the atmosphere, pressure rate, opening, angle and its rate and
/// acceleration, and the supply above the atmosphere; of both the length of the record. SI units.
struct EffectScales {
  double force = 1.0;              ///< N
  double length = 1.0;             ///< m
  double speed = 1.0;              ///< m/s
  double acceleration = 1.0;       ///< m/s^2
  double duration = 1.0;           ///< s
  double pressure = 1.0;           ///< Pa
  double pressure_rate = 1.0;      ///< Pa/s
  double opening = 1.0;            ///< -
  double supply = 1.0;             ///< Pa
  double angle = 1.0;              ///< rad
  double angle_rate = 1.0;         ///< rad/s
  double bend_acceleration = 1.0;  ///< rad/s^2
};

/// A parameter that is estimated together with those of the base model. Its prior is N(mean, sd^2) cut at the bounds,
/// in multiples of `unit_size`.
struct EffectAmplitude {
  std::string_view name;
  std::string_view unit;
  double mean, sd, lower, upper;                             ///< lower = 0 where the physics has a sign.
  double (*unit_size)(const EffectScales& scales) noexcept;  ///< In the parameter's unit.
};

/// A parameter that is frozen while the estimator runs.
struct EffectShape {
  std::string_view name;
  std::string_view unit;
  double typical;  ///< Multiple of `unit_size`.
  double (*unit_size)(const EffectScales& scales) noexcept;
  double lower, upper;  ///< Allowed values, in the parameter's unit.
};

/// One physical effect of the catalogue of a compiled plant. What else an effect has, is up to the plant: see
/// effects.hpp of its slice.
struct EffectInfo {
  std::string_view name;
  std::string_view family;
  std::string_view formula;
  EffectSlot slot;
  EffectNeeds needs;
  bool online;  ///< The estimator can run it.
  int num_amplitudes;
  std::array<EffectAmplitude, kMaxEffectAmplitudes> amplitudes;
  int num_shapes;
  std::array<EffectShape, kMaxEffectShapes> shapes;
};

namespace effect_unit {
// Sizes by which priors and typical shapes are scaled.
constexpr double One(const EffectScales&) noexcept { return 1.0; }
constexpr double Force(const EffectScales& s) noexcept { return s.force; }
constexpr double Length(const EffectScales& s) noexcept { return s.length; }
constexpr double Speed(const EffectScales& s) noexcept { return s.speed; }
constexpr double ForcePerTime(const EffectScales& s) noexcept { return s.force / s.duration; }
constexpr double ForcePerSpeed(const EffectScales& s) noexcept { return s.force / s.speed; }
constexpr double ForcePerLength(const EffectScales& s) noexcept { return s.force / s.length; }
constexpr double ForcePerAcceleration(const EffectScales& s) noexcept { return s.force / s.acceleration; }
constexpr double PerTime(const EffectScales& s) noexcept { return 1.0 / s.duration; }
constexpr double Duration(const EffectScales& s) noexcept { return s.duration; }
constexpr double Pressure(const EffectScales& s) noexcept { return s.pressure; }
constexpr double FlowPerPressure(const EffectScales& s) noexcept { return s.pressure_rate / s.pressure; }
constexpr double Opening(const EffectScales& s) noexcept { return s.opening; }
constexpr double SupplyPerOpening(const EffectScales& s) noexcept { return s.supply / s.opening; }
constexpr double Angle(const EffectScales& s) noexcept { return s.angle; }
constexpr double AngleRate(const EffectScales& s) noexcept { return s.angle_rate; }
constexpr double BendAcceleration(const EffectScales& s) noexcept { return s.bend_acceleration; }
constexpr double BendPerCubedAngle(const EffectScales& s) noexcept {
  return s.bend_acceleration / (s.angle * s.angle * s.angle);
}
}  // namespace effect_unit

}  // namespace armcmc
