#pragma once

#include <array>
#include <cstdint>

namespace armcmc::plant_sim {

/// Durations in a fixed memory: bins 1/16 of an octave wide (4.4 %), from 1 us to an hour; the maximum is exact.
class LatencyHistogram {
 public:
  /// Negative durations count as zero. @rt No heap, no lock, no throw.
  void Add(std::int64_t duration_ns) noexcept;

  [[nodiscard]] std::int64_t count() const noexcept { return count_; }
  [[nodiscard]] double max_ms() const noexcept { return static_cast<double>(max_ns_) * 1e-6; }
  /// Smallest bin edge below which a share q of the durations lies, never above the maximum; 0 without any.
  [[nodiscard]] double QuantileMs(double q) const noexcept;

 private:
  static constexpr int kPerOctave = 16, kOctaves = 32;
  std::array<std::int64_t, kPerOctave * kOctaves> bins_{};
  std::int64_t count_ = 0, max_ns_ = 0;
};

}  // namespace armcmc::plant_sim
