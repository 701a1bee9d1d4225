#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "armcmc/rt/log_histogram.hpp"
#include "armcmc/stress/fault_judge.hpp"
#include "armcmc/stress/options.hpp"

namespace armcmc::stress {

/// Faults of one kind, summed up: memory does not grow with the time.
struct FaultTally {
  const FaultSpec* fault = nullptr;
  std::int64_t injected = 0, detected = 0, swallowed = 0;
  std::int64_t recovered_steps = 0;  ///< Most of any.
  std::int64_t stalled_steps = 0;
  std::int64_t own_misses = 0;
  std::int32_t flags = 0;
  const char* hindrance = "";  ///< Of the slowest recovery.

  void Add(const FaultOutcome& outcome);
};

/// What one load came to.
struct PhaseResult {
  std::string load;
  std::vector<std::string> notes;
  double seconds = 0.0;
  nlohmann::ordered_json report;  ///< The estimator's; null when it left none.
  std::vector<FaultTally> faults;
  long rss_start_kb = 0, rss_end_kb = 0;
  std::int64_t own_misses_outside = 0;  ///< Own misses that no injected fault explains.
  rt::LogHistogram end_to_end;          ///< ns, release to estimate.
  std::size_t slots_per_run = 0;
  std::string trouble;  ///< "" when the estimator lived through it and wrote its report.
};

/// Runs one load with faults for so many seconds.
/// @param first     Number of the fault to begin with, of those that have a slot.
/// @param progress  Called with the share of this phase that is over.
[[nodiscard]] PhaseResult RunPhase(const StressOptions& options, const std::string& load, double seconds,
                                   std::size_t first, const std::function<void(double)>& progress);

}  // namespace armcmc::stress
