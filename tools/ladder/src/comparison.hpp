#pragma once

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

inline constexpr double kLeastGain = 0.1;  // of the squared error: what a name has to take

/// What a contender leaves on rows left out, over what its base leaves.
/// @param beside  Both with the flexible function beside them.
[[nodiscard]] Comparison Compare(const View& view, const Contender& c, const Trial& base_trial, bool beside);

/// Share of the squared error that is left which a flexible function takes, in folds.
[[nodiscard]] double FlexibleGain(const View& view, const Trial& trial);

/// Whether a trial leaves more than noise: what a flexible function takes, or what is rough at the sampling rate.
/// @param floor  Standard deviation of the noise; 0: nobody knows.
[[nodiscard]] bool LeavesMore(const View& view, const Trial& trial, double floor);

}  // namespace armcmc::ladder
