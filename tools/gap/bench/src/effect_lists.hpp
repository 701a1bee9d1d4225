#pragma once

#include <string>
#include <vector>

namespace armcmc::gap_bench {

using Words = std::vector<std::string>;

/// Effects of the contact plant by the formulas of the tool's catalogue.
inline const Words kCatalogue = {"force_bias:constant",       "force_drift:linear",      "coulomb_friction:tanh",
                                 "presliding_friction:dahl",  "viscous_friction:linear", "inertia:rigid",
                                 "sensor_delay:dead_time",    "sensor_lag:first_order",  "stress_relaxation:linear",
                                 "adhesion:exponential",      "contact_offset:shift",    "sensor_saturation:clip",
                                 "periodic_disturbance:sine", "stiffness_drift:linear"};
/// The same physics by other formulas.
inline const Words kVariants = {"coulomb_friction:sign",
                                "coulomb_friction:stribeck",
                                "presliding_friction:lugre",
                                "stress_relaxation:elastic",
                                "stress_relaxation:two_time_constants",
                                "adhesion:pull_off",
                                "stiffness_drift:exponential",
                                "sensor_lag:second_order",
                                "force_drift:exponential",
                                "periodic_disturbance:square"};
/// What the tool's catalogue lacks.
inline const Words kOutside = {"quadratic_drag", "strain_stiffening", "backlash", "dead_zone", "spatial_ripple"};
/// Effects of the soft actuator.
inline const Words kActuator = {"leak:linear",
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

inline constexpr const char* kRich = "contact_rich";
inline constexpr const char* kExcited = "soft_actuator_excited";

}  // namespace armcmc::gap_bench
