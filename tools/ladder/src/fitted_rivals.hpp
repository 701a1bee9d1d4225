#pragma once

#include <vector>

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

/// Fits candidates outside the catalogue to all training rows, from the fit of the base model and the prior means of
/// what they add. One that does not converge, or is beyond the limits of a plant, is not `refined`.
[[nodiscard]] std::vector<Contender> FittedRivals(std::vector<Candidate> candidates, const Dataset& data,
                                                  const Trial& base);

/// The first of them that explains as much as an effect, on data left out; null: none does. Judges those that it asks.
/// @pre c.trial.judged.
[[nodiscard]] const Contender* FirstThatExplainsAsMuch(std::vector<Contender>* rivals, const View& view,
                                                       const Trial& base, const Contender& c);

}  // namespace armcmc::ladder
