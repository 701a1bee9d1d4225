#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/equation.hpp"
#include "armcmc/gap/recording.hpp"

namespace armcmc::gap {

/// One equation of a plant with its diagnosis.
struct EquationDiagnosis {
  std::unique_ptr<Equation> equation;
  Suitability suitability;
  Diagnosis diagnosis;
};

/// The diagnosis of every equation of a plant: each is searched separately, and a missing term is attributed to the one
/// in which it is named, else to the one with the larger gap.
struct PlantDiagnosis {
  std::vector<EquationDiagnosis> equations;
  std::size_t carrier = 0;         ///< That equation; without a gap, one that can be judged.
  std::vector<std::string> notes;  ///< Equations that cannot be judged; decisions of one equation for another.

  [[nodiscard]] const EquationDiagnosis& carrying() const { return equations[carrier]; }
  [[nodiscard]] EquationDiagnosis& carrying() { return equations[carrier]; }
  /// Other equations with a gap of their own.
  [[nodiscard]] std::vector<const EquationDiagnosis*> Others() const;
};

/// Diagnoses each equation of a model on one recording.
///
/// An effect of a sensor that several equations use appears in all of them: if it is ambiguous in one equation and also
/// in the catalogue of another, the other equation tests it at the value estimated by the first, and rejects or
/// confirms it.
/// @throws std::invalid_argument, with the reason, if the model is unknown or the recording cannot be used.
[[nodiscard]] PlantDiagnosis DiagnosePlant(const std::string& model, const Recording& recording,
                                           const DiagnoseOptions& options = {});

}  // namespace armcmc::gap
