#include "rate_of.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "armcmc/support/median_step.hpp"
#include "zero_phase.hpp"

namespace armcmc::support {
namespace {

constexpr double kGap = 1.5;         // steps, from which on rows are missing
constexpr double kUneven = 0.02;     // steps, that the time of a row may be off
constexpr std::size_t kFewest = 10;  // rows of a stretch that is filtered

struct Stretch {
  std::size_t first, last;
  [[nodiscard]] std::size_t size() const { return last - first; }
};

std::vector<Stretch> Stretches(const std::vector<double>& t) {
  const double step = MedianStep(t);
  std::vector<Stretch> stretches{{0, 1}};
  for (std::size_t n = 1; n < t.size(); ++n) {
    if (t[n] - t[n - 1] > kGap * step) stretches.push_back({n, n});
    stretches.back().last = n + 1;
  }
  return stretches;
}

bool IsEven(const std::vector<double>& t, const Stretch& stretch, double dt) {
  for (std::size_t n = stretch.first; n < stretch.last; ++n)
    if (std::fabs(t[n] - t[stretch.first] - static_cast<double>(n - stretch.first) * dt) > kUneven * dt) return false;
  return true;
}

std::vector<double> CentralDifferences(const std::vector<double>& t, const std::vector<double>& x) {
  std::vector<double> rate(t.size());
  for (std::size_t n = 0; n < t.size(); ++n) {
    const std::size_t before = n == 0 ? 0 : n - 1, after = std::min(n + 1, t.size() - 1);
    rate[n] = (x[after] - x[before]) / (t[after] - t[before]);
  }
  return rate;
}

}  // namespace

Rate RateOf(const std::vector<double>& t, const std::vector<double>& x) {
  const std::vector<Stretch> stretches = Stretches(t);
  const Stretch& longest = *std::max_element(stretches.begin(), stretches.end(),
                                             [](const Stretch& a, const Stretch& b) { return a.size() < b.size(); });
  if (longest.size() < kFewest) return {CentralDifferences(t, x)};
  const double dt = (t[longest.last - 1] - t[longest.first]) / static_cast<double>(longest.size() - 1);
  const bool filtered = std::all_of(stretches.begin(), stretches.end(), [&](const Stretch& stretch) {
    return stretch.size() >= kFewest && IsEven(t, stretch, dt);
  });
  if (!filtered) return {CentralDifferences(t, x)};

  const auto part = [&](const Stretch& stretch) {
    return std::vector<double>(x.begin() + static_cast<std::ptrdiff_t>(stretch.first),
                               x.begin() + static_cast<std::ptrdiff_t>(stretch.last));
  };
  Rate rate;
  rate.bandwidth_hz = SuitableBandwidth(part(longest), dt);
  rate.value.reserve(t.size());
  for (const Stretch& stretch : stretches) {
    const std::vector<double> derived = Derivative(ZeroPhase(part(stretch), dt, rate.bandwidth_hz), dt);
    rate.value.insert(rate.value.end(), derived.begin(), derived.end());
  }
  return rate;
}

}  // namespace armcmc::support
