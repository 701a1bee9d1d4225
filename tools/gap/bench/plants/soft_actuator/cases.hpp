#pragma once

#include <string>
#include <vector>

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

}  // namespace armcmc::gap_bench
