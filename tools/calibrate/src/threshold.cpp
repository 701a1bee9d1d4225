#include "armcmc/calibrate/threshold.hpp"

#include <algorithm>
#include <cmath>

namespace armcmc::calibrate {

double ThresholdScore(const ForgettingSettings& settings, const ModeEstimate& mode, int pack_samples) {
  const double weight = std::sqrt(static_cast<double>(mode.num_samples) / pack_samples);
  const double allowance = mode.zeta_threshold - settings.threshold / weight;
  const double distance = mode.zeta - settings.mu;
  const double excess = settings.index == MismatchIndex::kSignedMean ? std::fabs(distance) : distance;
  return weight * (excess - allowance);
}

ThresholdChoice ChooseThreshold(std::vector<double> scores, double rate) {
  constexpr double kEnough = 10.0;
  constexpr std::size_t kTail = 20;
  std::sort(scores.begin(), scores.end());
  const auto n = static_cast<double>(scores.size());
  ThresholdChoice choice;
  if (rate * n >= kEnough) {
    choice.threshold = scores[static_cast<std::size_t>(std::floor((1.0 - rate) * (n - 1.0)))];
  } else {
    const std::size_t tail = std::min(std::max(scores.size() / 10, kTail), scores.size() - 1);
    const double u = scores[scores.size() - tail - 1];
    double excess = 0.0;
    for (std::size_t i = scores.size() - tail; i < scores.size(); ++i) excess += scores[i] - u;
    const auto share = static_cast<double>(tail) / n;
    choice.threshold = u + excess / static_cast<double>(tail) * std::log(share / rate);
    choice.extrapolated = true;
  }
  if (choice.threshold < kSmallestThreshold) {
    choice.threshold = kSmallestThreshold;
    choice.at_floor = true;
    choice.extrapolated = false;
  }
  choice.measured_rate =
      static_cast<double>(scores.end() - std::lower_bound(scores.begin(), scores.end(), choice.threshold)) / n;
  return choice;
}

}  // namespace armcmc::calibrate
