#pragma once

#include <vector>

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

/// What the names are tested again with. All outlive it.
struct Again {
  const Dataset& all;           ///< With the held-out rows.
  const Dataset& data;          ///< The rows on which models are compared.
  const PlantDescription& own;  ///< The plant as it came, without constants that effects brought.
  double floor;                 ///< Standard deviation of the noise.
  double start_sd;              ///< Error of the plant without effects.
};

/// Rule 7 of Climb(), once: finds the first effect that does not hold with those in the model that were named after it,
/// replaces it or drops it, and names the others again in the order of what they explain.
/// @param full     The model with all of them.
/// @param dropped  Effects that did not hold before, which do not come back; receives the one that does not hold now.
/// @param ladder   If something changes, its last rung names something, and no other rung names several effects.
/// @return whether something was changed.
[[nodiscard]] bool Reselect(const Again& again, const Trial& full, std::vector<Candidate>* dropped, Ladder* ladder);

}  // namespace armcmc::ladder
