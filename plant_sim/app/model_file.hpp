#pragma once

#include <filesystem>

#include "armcmc/plant_sim/scenario.hpp"

namespace armcmc::plant_sim {

/// Makes the plant of a model file the plant of the scenario: the means of its parameters, and its effects at the means
/// of their amplitudes. Motion, sensors and duration stay the scenario's; its noise is left to the scenario, too.
///
/// A model of valves has one prior for both, which says nothing on either: gains and constants stay
/// the scenario's, and the effects are added.
///
/// The equations are the plant's own. They give what the estimator's composed model predicts but for
///   inertia               x'' by a second-order difference; `smoothing` is the estimator's filter, not the plant's
///   sensor_lag            the whole past, of which the estimator keeps eight of the longest time constants it allows
///   sensor_saturation     clips at -limit, too
///   stress_relaxation, adhesion   together with contact_offset see the shifted surface
/// @throws support::ConfigError naming file, line, key and what is allowed, or why the two do not fit.
void ApplyModelFile(const std::filesystem::path& path, Scenario* scenario);

}  // namespace armcmc::plant_sim
