#pragma once

#include <string>
#include <utility>
#include <vector>

namespace armcmc::gap_bench {

/// Effects of the contact plant by the formulas of the tool's catalogue.
inline const std::vector<std::string> kCatalogue = {
    "force_bias:constant",       "force_drift:linear",    "coulomb_friction:tanh",  "presliding_friction:dahl",
    "viscous_friction:linear",   "inertia:rigid",         "sensor_delay:dead_time", "sensor_lag:first_order",
    "stress_relaxation:linear",  "adhesion:exponential",  "contact_offset:shift",   "sensor_saturation:clip",
    "periodic_disturbance:sine", "stiffness_drift:linear"};
/// The same physics by other formulas.
inline const std::vector<std::string> kVariants = {"coulomb_friction:sign",
                                                   "coulomb_friction:stribeck",
                                                   "presliding_friction:lugre",
                                                   "stress_relaxation:elastic",
                                                   "stress_relaxation:two_time_constants",
                                                   "adhesion:pull_off",
                                                   "stiffness_drift:exponential",
                                                   "sensor_lag:second_order",
                                                   "force_drift:exponential",
                                                   "periodic_disturbance:square"};
/// What the plant's own catalogue lacks.
inline const std::vector<std::string> kOutside = {"quadratic_drag", "strain_stiffening", "backlash", "dead_zone",
                                                  "spatial_ripple"};
/// What the plant's own catalogue lacks, or is made to lack, and the name of the same physics among the effects that
/// serve every plant. Dahl's friction is a case of the Bouc-Wen hysteresis.
inline const std::vector<std::pair<std::string, std::string>> kServeEveryPlant = {
    {"quadratic_drag", "drag"},
    {"backlash", "backlash"},
    {"dead_zone", "sensor_dead_zone"},
    {"spatial_ripple", "cogging"},
    {"strain_stiffening", "cubic_stiffness"},
    {"strain_stiffening", "quadratic_stiffness"},
    {"presliding_friction", "hysteresis"}};
inline constexpr const char* kRich = "contact_rich";
inline constexpr const char* kPaper = "hunt_crossley_paper";

}  // namespace armcmc::gap_bench
