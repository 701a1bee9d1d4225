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
  unsigned long long seed = 1;       ///< Of the bootstrap.
  bool pairs = true;                 ///< Whether two effects at once are tried.
  std::vector<std::string> without;  ///< Effects to leave out of the catalogue.
  /// Effects that the model has already.
  std::vector<std::pair<std::string, When>> known;
  Thresholds thresholds;
};

/// One look at a recording with one smoother: what was found, and all that it refers to.
struct Look {
  Signals signals;
  std::vector<EffectForm> catalogue;
  std::unique_ptr<Fitter> fitter;
  std::unique_ptr<Search> search;
  Finding finding;
};

/// What the data say, whichever smoother looks.
struct Diagnosis {
  std::unique_ptr<BlockBootstrap> bootstrap;
  std::unique_ptr<Look> look;    ///< With the wider smoother.
  std::unique_ptr<Look> narrow;  ///< With the narrower one; null when there was nothing to vote on. Candidates of
                                 ///< `finding` may refer to it.
  Finding finding;               ///< Of that look, with the vote of the other applied.
  std::vector<std::string> notes;
};

/// Fits, judges and names: steps one to three of the workflow, without where.
///
/// Deterministic for a seed. The verdict must not hang on the smoother of the inputs: a second look with a narrower one
/// votes, and where the two name different effects both are reported.
[[nodiscard]] Diagnosis Diagnose(const Equation& equation, const Recording& recording,
                                 const DiagnoseOptions& options = {});

/// Fits the base model and says nothing: for a recording on which the equation's Check allows no name. There is no
/// search in its look.
[[nodiscard]] Diagnosis CompareOnly(const Equation& equation, const Recording& recording,
                                    const DiagnoseOptions& options = {});

}  // namespace armcmc::gap
