#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "armcmc/gap/run.hpp"
#include "armcmc/ladder/tuned.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::ladder {

/// Lets the estimator go over a recording with the plant as it came and with what was named, and notes how well it
/// predicts one pack ahead. Of a recording of more than 50 000 rows the first part of every run.
/// @param after  Null: nothing was named.
[[nodiscard]] gap::RunAlong RunAlong(const std::shared_ptr<const support::Recording>& whole, const TunedPlant& before,
                                     const TunedPlant* after, std::uint64_t seed,
                                     const std::function<void(double share)>& progress);

}  // namespace armcmc::ladder
