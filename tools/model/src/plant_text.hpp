#pragma once

#include <string>

#include "armcmc/plant/plant.hpp"

namespace armcmc::model {

/// What was understood of a plant file, as tables for people: signals, parameters with their priors, states, modes with
/// their laws, noise; and whether the estimator runs it.
[[nodiscard]] std::string PlantText(const Plant& plant);

}  // namespace armcmc::model
