#pragma once

#include "armcmc/estimate_t.hpp"
#include "armcmc/plant_sim/plant.hpp"
#include "armcmc/plant_sim/scorer.hpp"

namespace armcmc::plant_sim {

/// Sorts a message by the names of its parameters into the order of the family. A parameter that the message
/// lacks leaves its modes unknown. @param arrival_s plant time at which it arrived.
[[nodiscard]] ReceivedEstimate ReadEstimate(const PlantFamily& family, const estimate_t& message, double arrival_s);

}  // namespace armcmc::plant_sim
