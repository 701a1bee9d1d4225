#pragma once

#include "armcmc/gap/result.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::gap {

/// What the estimator pays for the effects: the median time of its adjust computation over the packs of a recording,
/// with the base model and with the augmented one, side by side on this machine.
/// @param packs  Where they come from, and their length, which is the deadline, too; the plant is filled in.
/// @throws support::InputError when the recording holds no whole pack.
[[nodiscard]] Budget MeasureBudget(const EstimatorSettings& base, const EstimatorSettings& augmented,
                                   const replay::SourceRequest& packs);

}  // namespace armcmc::gap
