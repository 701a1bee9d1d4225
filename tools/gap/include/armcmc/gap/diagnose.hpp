#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/gap/equation.hpp"
#include "armcmc/gap/recording.hpp"
#include "armcmc/gap/search.hpp"
#include "armcmc/gap/thresholds.hpp"

namespace armcmc::gap {

struct DiagnoseOptions {
  unsigned long long seed = 1;       ///< Seed of the bootstrap.
  bool pairs = true;                 ///< Whether pairs of effects are tested.
  std::vector<std::string> without;  ///< Effects to leave out of the catalogue.
  /// Effects that the model already contains.
  std::vector<std::pair<std::string, When>> known;
  Thresholds thresholds;
  /// The law may err by a smooth factor (Equation::LawError) that every hypothesis has and no report; the noise is that
  /// above the band of the law. For misfits that the exact law with any effect leaves unnamed.
  bool law_errs = false;
};

/// The analysis of a recording with one smoother: the finding, and everything that it refers to.
struct Analysis {
  Signals signals;
  std::vector<EffectForm> catalogue;
  std::unique_ptr<Fitter> fitter;
  std::unique_ptr<Search> search;
  Finding finding;
};

/// The diagnosis of a recording, independent of the smoother.
struct Diagnosis {
  std::unique_ptr<BlockBootstrap> bootstrap;
  std::unique_ptr<Analysis> wide;    ///< With the wider smoother.
  std::unique_ptr<Analysis> narrow;  ///< With the narrower one; null if it was not needed. Candidates of `finding`
                                     ///< may refer to it.
  Finding finding;                   ///< The finding of `wide`, checked against that of `narrow`.
  std::vector<std::string> notes;
};

/// Fits, tests for adequacy and names: steps one to three of the workflow, without the localisation.
///
/// Deterministic for a seed. The verdict must not depend on the smoother of the inputs: the analysis is repeated with a
/// narrower one, and if the two name different effects, both are reported.
[[nodiscard]] Diagnosis Diagnose(const Equation& equation, const Recording& recording,
                                 const DiagnoseOptions& options = {});

/// Fits the base model only: for a recording that the equation's Check finds unsuitable. Its `wide` contains no search.
[[nodiscard]] Diagnosis CompareOnly(const Equation& equation, const Recording& recording,
                                    const DiagnoseOptions& options = {});

}  // namespace armcmc::gap
