#pragma once

#include <string>

#include "armcmc/plant/plant.hpp"

namespace armcmc::model {

/// What was understood of a plant file, as tables for people: signals, parameters with their priors, states, modes with
/// their laws, noise; and what the estimator samples.
[[nodiscard]] std::string PlantText(const Plant& plant);

}  // namespace armcmc::model
