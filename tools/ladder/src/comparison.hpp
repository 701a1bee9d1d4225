#pragma once

#include "armcmc/ladder/climb.hpp"

namespace armcmc::ladder {

inline constexpr double kLeastGain = 0.1;   // of the squared error: what a name has to take
inline constexpr double kLargerPart = 0.5;  // of what is no noise in it: what the first name of a family leaves at most
inline constexpr double kFarBetter = 2.0;   // times less than a simple one leaves: what a larger one has to show

/// What a contender leaves on rows left out, over what its base leaves.
/// @param beside  Both with the flexible function beside them.
[[nodiscard]] Comparison Compare(const View& view, const Contender& c, const Trial& base_trial, bool beside);

/// "leaves 4.5 times less squared error on data left out"
[[nodiscard]] std::string LeavesLess(double times);

/// Better wherever it is looked for.
[[nodiscard]] bool BetterEverywhere(const Contender& a, const Contender& b);

/// Share of the squared error that is left which a flexible function takes, in folds.
[[nodiscard]] double FlexibleGain(const View& view, const Trial& trial);

/// Whether a trial leaves more than noise: what a flexible function takes, or errors that are larger than neighbouring
/// samples differ; by little where they are forgotten within a tenth of the period.
/// @param floor  Standard deviation of the noise; 0: nobody knows.
[[nodiscard]] bool LeavesMore(const View& view, const Trial& trial, double floor);

}  // namespace armcmc::ladder
