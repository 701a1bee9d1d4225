#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "armcmc/gap/run.hpp"
#include "armcmc/ladder/tuned.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::ladder {

/// Runs the estimator over a recording, with the original plant and with the named effects, and measures its
/// predictions one pack ahead. Of a recording with more than 50 000 rows, only the first part of every run is used.
/// @param after  Null if nothing was named.
[[nodiscard]] gap::RunAlong RunAlong(const std::shared_ptr<const support::Recording>& whole, const TunedPlant& before,
                                     const TunedPlant* after, std::uint64_t seed,
                                     const std::function<void(double share)>& progress);

}  // namespace armcmc::ladder
