#pragma once

#include "armcmc/gap/result.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::gap {

/// Cost of the effects for the estimator: the median time of the adjust stage over the packs of a recording, with the
/// base model and with the extended one, in turn on this machine.
/// @param packs  Source and length of the packs; the length is also the deadline. The plant is filled in.
/// @throws support::InputError if the recording contains no complete pack.
[[nodiscard]] Budget MeasureBudget(const EstimatorSettings& base, const EstimatorSettings& augmented,
                                   const replay::SourceRequest& packs);

}  // namespace armcmc::gap
