#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/equation.hpp"
#include "armcmc/gap/recording.hpp"

namespace armcmc::gap {

/// One equation of a plant with what the data say on it.
struct EquationDiagnosis {
  std::unique_ptr<Equation> equation;
  Suitability suitability;
  Diagnosis diagnosis;
};

/// What the data say on every equation of a plant: a missing term is sought in each by itself, and belongs to the one
/// that carries the gap.
struct PlantDiagnosis {
  std::vector<EquationDiagnosis> equations;
  std::size_t carrier = 0;         ///< The equation that carries the gap; without a gap, one that can be judged.
  std::vector<std::string> notes;  ///< Equations on which nothing can be said; what one decided for another.

  [[nodiscard]] const EquationDiagnosis& carrying() const { return equations[carrier]; }
  [[nodiscard]] EquationDiagnosis& carrying() { return equations[carrier]; }
  /// Equations beside the carrier that have a gap of their own.
  [[nodiscard]] std::vector<const EquationDiagnosis*> Others() const;
};

/// Diagnoses each equation of a model on one recording.
///
/// A sensor that several equations read shows in all of them: where one leaves an effect in doubt that another has in
/// its catalogue, too, the other is asked at the value that the first estimates, and strikes it or confirms it.
/// @throws std::invalid_argument when the model is unknown or the recording cannot be used; says why.
[[nodiscard]] PlantDiagnosis DiagnosePlant(const std::string& model, const Recording& recording,
                                           const DiagnoseOptions& options = {});

}  // namespace armcmc::gap
