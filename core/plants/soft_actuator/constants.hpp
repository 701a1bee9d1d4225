#pragma once

#include <array>
#include <limits>

#include "armcmc/models/compiled_plant.hpp"

namespace armcmc {

/// What is known of the actuator, by name. As built: the paper's.
struct ActuatorConstants {
  double p_atm = 101'325.0;  ///< Pa
  double p_supply = 800e3;   ///< Pa
  double q1 = 1408.5;        ///< rad/s^2 per unit of p - p_atm
  double q2 = 132.28;        ///< 1/s
  double q3 = 3319.4;        ///< 1/s^2

  constexpr ActuatorConstants() = default;
  /// Of settings of this plant.
  constexpr ActuatorConstants(const PlantConstants& c) noexcept
      : p_atm(c[0]), p_supply(c[1]), q1(c[2]), q2(c[3]), q3(c[4]) {}
  constexpr operator PlantConstants() const noexcept { return {p_atm, p_supply, q1, q2, q3}; }
};

namespace actuator_detail {
inline constexpr double kTiny = 1e-100, kAny = std::numeric_limits<double>::max();
inline constexpr ActuatorConstants kPaper;
}  // namespace actuator_detail

inline constexpr std::array<ConstantInfo, 5> kActuatorConstants{
    {{"p_atm", "Pa", actuator_detail::kPaper.p_atm, actuator_detail::kTiny, actuator_detail::kAny, ""},
     {"p_supply", "Pa", actuator_detail::kPaper.p_supply, actuator_detail::kTiny, actuator_detail::kAny, "p_atm"},
     {"q1", "rad/(s^2 Pa)", actuator_detail::kPaper.q1, -actuator_detail::kAny, actuator_detail::kAny, ""},
     {"q2", "1/s", actuator_detail::kPaper.q2, 0.0, actuator_detail::kAny, ""},
     {"q3", "1/s^2", actuator_detail::kPaper.q3, 0.0, actuator_detail::kAny, ""}}};

}  // namespace armcmc
