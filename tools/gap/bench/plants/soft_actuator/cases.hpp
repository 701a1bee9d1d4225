#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "plants/soft_actuator/effects.hpp"
#include "src/bench_equation.hpp"

namespace armcmc::gap_bench {

/// Effects of the soft actuator by the formulas of the tool's catalogue.
inline const std::vector<std::string> kActuator = {"leak:linear",
                                                   "valve_dead_band:rescaled",
                                                   "valve_lag:spool",
                                                   "supply_droop:opening",
                                                   "pressure_bias:constant",
                                                   "angle_bias:constant",
                                                   "sensor_delay:dead_time",
                                                   "joint_friction:tanh",
                                                   "cubic_stiffness:cubic",
                                                   "gravity_load:sine",
                                                   "hysteresis:bouc_wen",
                                                   "payload_step:inertia",
                                                   "periodic_disturbance:sine"};

/// What the tool's catalogue lacks.
inline const std::vector<std::string> kActuatorOutside = {"quadratic_drag", "obstacle"};

inline constexpr const char* kExcited = "soft_actuator_excited";
/// Constants that the tool is told, as lines of that scenario.
inline const std::vector<std::string> kTakenForGranted = {"p_supply = 800000.0", "q1 = 0.0704", "q3 = 3319.4"};

namespace actuator_detail {
inline bool ActsOnFlow(std::string_view effect) noexcept { return FlowEffects::Find(effect) >= 0; }
/// The pressure that is measured enters both.
inline bool ActsOnBend(std::string_view effect) noexcept {
  return !ActsOnFlow(effect) || effect == PressureBias::kInfo.name;
}
}  // namespace actuator_detail

inline constexpr std::array<BenchEquation, 2> kActuatorEquations{
    {{"flow law", actuator_detail::ActsOnFlow}, {"bend equation", actuator_detail::ActsOnBend}}};

}  // namespace armcmc::gap_bench
