#pragma once

#include <string>
#include <vector>

#include "armcmc/gap/plant_diagnosis.hpp"

namespace armcmc::gap {

/// What of a diagnosis the estimator can run: effects in the catalogue's own formulas, in the equation that it
/// estimates. An effect that another equation found runs too, where that equation has it in its catalogue (a sensor
/// that both read); its parameters are then fitted there.
struct OnlinePart {
  const EquationDiagnosis* equation = nullptr;  ///< Null: nothing can run.
  Fitted fit;
  bool other_formula = false;         ///< What was found is another formula of the effect.
  std::vector<std::string> left_out;  ///< Effects that were found and cannot run.
};

/// @pre the carrier's finding names something: its set is not empty.
[[nodiscard]] OnlinePart OnlinePartOf(const PlantDiagnosis& plant);

}  // namespace armcmc::gap
