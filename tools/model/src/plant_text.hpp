#pragma once

#include <string>

#include "armcmc/plant/plant.hpp"

namespace armcmc::model {

/// The estimator runs plants of its kind: no states, and no output but what the law explains.
[[nodiscard]] bool MayRun(const Plant& plant);

/// What was understood of a plant file, as tables for people: signals, parameters with their priors, states, modes with
/// their laws, noise; and what the estimator samples.
/// @pre Where MayRun(plant): it is within the limits of PlantProgram.
[[nodiscard]] std::string PlantText(const Plant& plant);

}  // namespace armcmc::model
