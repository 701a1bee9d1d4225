#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "armcmc/change_t.hpp"
#include "armcmc/data_pack_t.hpp"
#include "armcmc/estimate_t.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "armcmc/plant_truth_t.hpp"
#include "armcmc/posterior_t.hpp"
#include "armcmc/watch/history.hpp"

namespace armcmc::watch {

/// Messages on our channels that are not ours.
struct BusCounts {
  std::int64_t foreign = 0;      ///< The fingerprint of another type, or of another version of it.
  std::int64_t undecodable = 0;  ///< Our fingerprint, but cut short.
};

/// Everything that is shown, taken from the messages of one estimator and its plant. Times are seconds of a clock that
/// never jumps.
struct WatchState {
  std::string url;
  std::string prefix;
  double started_s = 0.0;

  std::optional<estimator_status_t> status;
  std::optional<estimate_t> estimate;
  std::optional<posterior_t> posterior;
  std::optional<change_t> change;
  std::optional<plant_truth_t> truth;
  double status_s = 0.0;   ///< When the newest status came.
  double period_s = 0.0;   ///< Mean time between two statuses; 0 before the second.
  std::int64_t steps = 0;  ///< Statuses of a step that was made, seen here.
  int held_faults = 0;     ///< Faults of the last seconds: one of a single period would be gone before it was read.
  double faults_s = 0.0;
  std::array<History, estimate_t::MAX_PARAMS> means;
  History end_to_end_ms;
  History zeta;
  History drifted;  ///< Probability of drift, of the mode whose parameters are reported.
  BusCounts bus;

  void Take(const estimator_status_t& message, double now_s);
  void Take(const estimate_t& message, double now_s);
  void Take(const posterior_t& message, double now_s);
  void Take(const change_t& message, double now_s);
  void Take(const plant_truth_t& message, double now_s);

  /// Decodes a message of one of our channels, or counts it as foreign.
  /// @param name  Channel without the prefix; names that are not ours are skipped.
  /// @return true when it was the status of a step, the last message that a step sends.
  bool TakeBytes(const std::string& name, const void* bytes, int size, double now_s);
};

/// True when the message holds the times of a step; without data there are statuses, but no steps.
[[nodiscard]] inline bool HasStep(const estimator_status_t& status) noexcept { return status.end_to_end_ns > 0; }

}  // namespace armcmc::watch
