#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "armcmc/estimate.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/interleaved_estimator.hpp"
#include "armcmc/replay/pack_source.hpp"

namespace armcmc::replay {

/// What a replay did.
struct ReplaySummary {
  std::int64_t packs = 0;  ///< Used.
  std::int64_t held = 0;   ///< Of those, packs without information about any parameter.
  std::int64_t modifications = 0;
  std::int64_t truncated = 0;          ///< Cut at the recorded number of draws.
  std::int64_t refused = 0;            ///< By the estimator; nothing was learnt from them.
  double data_s = 0.0;                 ///< Time that the packs span.
  double compute_s = 0.0;              ///< Time that adjust and execute took.
  std::vector<double> pack_compute_s;  ///< The same of every pack used.
  Estimate last;                       ///< After the last pack.
};

/// Drives an estimator over a recording: no thread, no deadline, the same result every time.
/// @param on_estimate  Called after each pack.
/// @param forecast     Filled with what was expected of the pack before it was seen, before on_estimate; may be null.
ReplaySummary Replay(PackSource* source, Estimator* estimator,
                     const std::function<void(const RecordedPack&, const Estimate&)>& on_estimate,
                     PackForecast* forecast = nullptr);
/// The same where packs overlap: as in the real-time process, every pack by the recursion whose turn it is.
ReplaySummary Replay(PackSource* source, InterleavedEstimator* estimator,
                     const std::function<void(const RecordedPack&, const Estimate&)>& on_estimate,
                     PackForecast* forecast = nullptr);

}  // namespace armcmc::replay
