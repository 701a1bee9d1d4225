#pragma once

#include <string>

#include "armcmc/gap/result.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::gap {

/// What the estimator pays for the effects: the median time of its adjust computation over the packs of a recording,
/// with the base model and with the augmented one, side by side on this machine.
/// @param period_s  Length of a pack; also the deadline.
/// @throws support::InputError when the recording holds no whole pack.
[[nodiscard]] Budget MeasureBudget(const EstimatorSettings& base, const EstimatorSettings& augmented,
                                   const std::string& data, double period_s, bool skip_bad);

}  // namespace armcmc::gap
