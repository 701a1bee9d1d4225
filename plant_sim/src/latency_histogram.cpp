#include "armcmc/plant_sim/latency_histogram.hpp"

#include <algorithm>
#include <cmath>

namespace armcmc::plant_sim {

void LatencyHistogram::Add(std::int64_t duration_ns) noexcept {
  const std::int64_t clipped = std::max<std::int64_t>(duration_ns, 0);
  const double octaves = std::log2(std::max(static_cast<double>(clipped) * 1e-3, 1.0));
  const auto bin = static_cast<std::size_t>(octaves * kPerOctave);
  ++bins_[std::min(bin, bins_.size() - 1)];
  ++count_;
  max_ns_ = std::max(max_ns_, clipped);
}

double LatencyHistogram::QuantileMs(double q) const noexcept {
  const auto wanted = static_cast<std::int64_t>(std::ceil(q * static_cast<double>(count_)));
  std::int64_t below = 0;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    below += bins_[i];
    if (below >= wanted && below > 0)
      return std::min(1e-3 * std::exp2(static_cast<double>(i + 1) / kPerOctave), max_ms());
  }
  return 0.0;
}

}  // namespace armcmc::plant_sim
