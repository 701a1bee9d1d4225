#pragma once

#include <memory>
#include <string>
#include <vector>

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

/// What the names of a rung are checked against. All outlive it.
struct NameChecks {
  const Dataset& all;                  ///< With the held-out rows.
  const Dataset& data;                 ///< The rows on which models are compared.
  const PlantDescription& own;         ///< The plant as it came, without constants that effects brought.
  std::shared_ptr<const Plant> plant;  ///< The base model of the rung.
  const DataScales& scales;
  double floor;                         ///< Standard deviation of the noise.
  const Rung* open;                     ///< The previous rung, if its name depends on this one; else null.
  std::vector<const Candidate*> named;  ///< The effects in the base model.
  double explained;                     ///< Squared error that they removed, relative to what remains.
};

/// Gives a rung its name, by rules 2 to 5 of Climb(), unless a rival rules it out or the held-out data contradict it.
/// If nothing is in the base model and nothing is named, `as_if` is the best curve.
/// @param rung  Judged and sorted.
void NameAndConfirm(const NameChecks& checks, Rung* rung, std::vector<std::string>* notes);

}  // namespace armcmc::ladder
