#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/plant_diagnosis.hpp"

namespace armcmc::gap {

/// The part of a diagnosis that the estimator can run: effects in the catalogue's own formulas, in the equation that it
/// estimates. An effect found in another equation can run as well if it is in the catalogue of the estimated equation
/// (a sensor that both use); its parameters are then fitted there.
struct OnlinePart {
  const EquationDiagnosis* equation = nullptr;  ///< Null: nothing can run.
  Fitted fit;
  bool other_formula = false;         ///< The diagnosis found a variant formula of the effect.
  std::vector<std::string> left_out;  ///< Effects that were found but cannot run.
};

/// @pre the set of the carrier's finding is not empty.
[[nodiscard]] OnlinePart OnlinePartOf(const PlantDiagnosis& plant);

}  // namespace armcmc::gap
