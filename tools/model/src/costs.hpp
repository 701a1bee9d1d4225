#pragma once

#include <memory>
#include <string>

#include "armcmc/plant/program.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::model {

/// What the estimator pays for a plant: operations of its laws, and the time of a step on this machine, over the packs
/// of a recording or of made-up signals.
/// @param recording  May be null.
[[nodiscard]] std::string CostText(const std::shared_ptr<const PlantProgram>& program,
                                   const std::shared_ptr<const support::Recording>& recording);

/// Of a plant with states: inputs of which the first packs of a recording say that they do something else between
/// samples than the file; empty where there is none. Runs the estimator twice an input.
[[nodiscard]] std::string BetweenText(const std::shared_ptr<const PlantProgram>& program,
                                      const std::shared_ptr<const support::Recording>& recording);

}  // namespace armcmc::model
