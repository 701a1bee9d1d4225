#pragma once

#include "armcmc/effects/effect.hpp"

namespace armcmc {

/// Sizes of a contact: rms force in contact; depth, speed and acceleration of the motion; length of the record.
struct ContactScales {
  double force = 1.0;         ///< N
  double length = 1.0;        ///< m
  double speed = 1.0;         ///< m/s
  double acceleration = 1.0;  ///< m/s^2
  double duration = 1.0;      ///< s

  constexpr operator EffectScales() const noexcept { return {{force, length, speed, acceleration, duration}}; }
};

namespace contact_unit {
constexpr double Force(const EffectScales& s) noexcept { return s.size[0]; }
constexpr double Length(const EffectScales& s) noexcept { return s.size[1]; }
constexpr double Speed(const EffectScales& s) noexcept { return s.size[2]; }
constexpr double ForcePerTime(const EffectScales& s) noexcept { return s.size[0] / s.size[4]; }
constexpr double ForcePerSpeed(const EffectScales& s) noexcept { return s.size[0] / s.size[2]; }
constexpr double ForcePerLength(const EffectScales& s) noexcept { return s.size[0] / s.size[1]; }
constexpr double ForcePerAcceleration(const EffectScales& s) noexcept { return s.size[0] / s.size[3]; }
constexpr double PerTime(const EffectScales& s) noexcept { return 1.0 / s.size[4]; }
}  // namespace contact_unit

}  // namespace armcmc
