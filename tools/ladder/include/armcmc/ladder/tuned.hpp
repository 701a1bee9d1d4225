#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/ladder/trial.hpp"
#include "armcmc/plant/description.hpp"
#include "armcmc/plant/program.hpp"

namespace armcmc::ladder {

/// A plant with priors from a fit, for the estimator.
struct TunedPlant {
  PlantDescription plant;
  PlantDescription loose;                       ///< The same plant with its original priors.
  std::vector<std::string> held;                ///< Parameters that became constants.
  std::shared_ptr<const PlantProgram> program;  ///< Null if the estimator cannot run it.
  std::string why_not;                          ///< The reason.
};

/// The plant with priors centred on a fit: the standard deviations are three times those of the posterior, because the
/// next run differs from this one, but never larger than in the file. (If real data contradict the model in one pack,
/// the estimator restarts from its prior. With a prior ten times as wide it predicts the next pack up to three times
/// worse.)
///
/// A parameter of an effect becomes a constant if its posterior is more than a quarter as wide as its prior; the widest
/// is fixed first, and the others are then tested again. An estimator that learns from one pack at a time would let
/// such parameters wander along the directions that the data do not determine. Further parameters become constants if
/// there are more than the estimator samples, and so does any parameter at a bound, where the posterior does not have
/// the shape of a prior centred on the fit.
/// @param own   Number of parameters that the plant had before any effect. They come first, and are fixed only at a
///   bound.
/// @param rows  [row] 1: the row was fitted.
[[nodiscard]] TunedPlant Tuned(const PlantDescription& plant, std::size_t own, const Trial& trial,
                               const std::vector<std::uint8_t>& rows);

}  // namespace armcmc::ladder
