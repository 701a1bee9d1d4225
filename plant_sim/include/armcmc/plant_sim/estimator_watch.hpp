#pragma once

#include <cstdint>

namespace armcmc::plant_sim {

/// Notices that an estimator went silent or came back. Silent: it had answered, and then no estimate came for two
/// periods (half a period of tolerance is added, so that one skipped pack with a late successor raises no alarm).
class EstimatorWatch {
 public:
  explicit EstimatorWatch(std::int64_t period_ns) noexcept : limit_ns_(period_ns * 5 / 2) {}

  /// True when this estimate ends a silence.
  [[nodiscard]] bool OnEstimate(std::int64_t now_ns) noexcept;
  /// True when a silence is noticed now; once per silence.
  [[nodiscard]] bool NoticeSilence(std::int64_t now_ns) noexcept;

  [[nodiscard]] bool silent() const noexcept { return silent_; }
  [[nodiscard]] std::int64_t silences() const noexcept { return silences_; }
  [[nodiscard]] std::int64_t last_ns() const noexcept { return last_ns_; }

 private:
  std::int64_t limit_ns_;
  std::int64_t last_ns_ = 0;
  std::int64_t silences_ = 0;
  bool heard_ = false, silent_ = false;
};

}  // namespace armcmc::plant_sim
