#pragma once

#include <optional>

#include "armcmc/gap_bench/case.hpp"
#include "armcmc/gap_bench/plant.hpp"

namespace armcmc::gap_bench {

/// See Outcome::first_rung. The error that the true effects leave is that of the base model refitted to the same plant,
/// motion and noise without them, with whatever else is wrong in it.
/// @param scenario  Text of the case's scenario.
/// @return nothing where nothing was named, or the effect does not show in the part that is kept apart.
[[nodiscard]] std::optional<double> FirstRung(const PlantProcess& plant, const Outcome& outcome,
                                              const std::string& scenario);

/// See Outcome::model_error, of the part of the recording that is diagnosed.
[[nodiscard]] double ModelError(const PlantProcess& plant, const Outcome& outcome, const std::string& scenario);

}  // namespace armcmc::gap_bench
