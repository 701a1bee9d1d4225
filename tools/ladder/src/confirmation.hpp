#pragma once

#include "armcmc/ladder/dataset.hpp"
#include "armcmc/ladder/trial.hpp"

namespace armcmc::ladder {

/// Error of a name on the held-out data.
struct HeldOutErrors {
  double before = 0.0, after = 0.0;  ///< Not finite if the simulation diverges.
  bool agree = true;
};

/// Whether at least half of the gain in cross-validation is found there, too; or, where the effect acts less than
/// elsewhere and noise is most of the error, surely half of what is not noise. True if no data were held out.
/// @param gain   Fraction of the squared error of `before` that is removed in cross-validation.
/// @param noise  Squared error that is noise.
[[nodiscard]] HeldOutErrors ConfirmOnHeldOut(const Dataset& data, const Trial& before, const Trial& after, double gain,
                                             double noise);

}  // namespace armcmc::ladder
