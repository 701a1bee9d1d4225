#pragma once

#include "armcmc/effects/effect.hpp"

namespace armcmc {

/// Sizes of the driven joint: rms pressure above the atmosphere, its rate, opening, angle with its rate and
/// acceleration; the supply above the atmosphere; length of the record.
struct ActuatorScales {
  double pressure = 1.0;           ///< Pa
  double pressure_rate = 1.0;      ///< Pa/s
  double opening = 1.0;            ///< -
  double supply = 1.0;             ///< Pa
  double angle = 1.0;              ///< rad
  double angle_rate = 1.0;         ///< rad/s
  double bend_acceleration = 1.0;  ///< rad/s^2
  double duration = 1.0;           ///< s

  constexpr operator EffectScales() const noexcept {
    return {{pressure, pressure_rate, opening, supply, angle, angle_rate, bend_acceleration, duration}};
  }
};

namespace actuator_unit {
constexpr double Pressure(const EffectScales& s) noexcept { return s.size[0]; }
constexpr double FlowPerPressure(const EffectScales& s) noexcept { return s.size[1] / s.size[0]; }
constexpr double Opening(const EffectScales& s) noexcept { return s.size[2]; }
constexpr double SupplyPerOpening(const EffectScales& s) noexcept { return s.size[3] / s.size[2]; }
constexpr double Angle(const EffectScales& s) noexcept { return s.size[4]; }
constexpr double AngleRate(const EffectScales& s) noexcept { return s.size[5]; }
constexpr double BendAcceleration(const EffectScales& s) noexcept { return s.size[6]; }
constexpr double BendPerCubedAngle(const EffectScales& s) noexcept {
  return s.size[6] / (s.size[4] * s.size[4] * s.size[4]);
}
constexpr double Duration(const EffectScales& s) noexcept { return s.size[7]; }
}  // namespace actuator_unit

}  // namespace armcmc
