#pragma once

#include <vector>

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

/// What was named on the rungs before.
struct EarlierNames {
  std::vector<const Candidate*> effects;
  double explained = 0.0;  ///< Squared error that it removed, relative to what remains.

  /// The named effect that acts like `entry`; null if none does.
  [[nodiscard]] const Candidate* Like(const EffectEntry& entry) const;
  /// Whether an effect of another family is so small compared with it that an error of its formula would explain it.
  /// @pre c.trial.judged.
  [[nodiscard]] bool FormulaErrorExplains(const Contender& c) const;
};

}  // namespace armcmc::ladder
