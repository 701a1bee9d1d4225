#include "armcmc/sample_size.hpp"

#include <algorithm>
#include <cmath>

namespace armcmc {

double ChernoffBound(double epsilon, double delta) noexcept {
  return std::log(2.0 / (1.0 - delta)) / (2.0 * epsilon * epsilon);
}

double MinimumDraws(double lambda, double epsilon, double delta) noexcept ARMCMC_NONBLOCKING {
  const double chernoff = ChernoffBound(epsilon, delta);
  // Below this the root is lost in the rounding error of the degenerate relation at lambda = 0.
  constexpr double kDegenerate = 1e-9;
  if (!(lambda > kDegenerate)) return chernoff;
  if (lambda >= 1.0) return chernoff;
  const double rate = 2.0 * epsilon * epsilon;
  const auto excess = [&](double k) noexcept {
    const double inner = lambda * (1.0 - delta) + 2.0 * (1.0 - lambda) * std::exp(-rate * (1.0 - lambda) * k);
    return std::log(2.0 / inner) / rate - k;
  };
  double lo = 0.0;
  double hi = chernoff;
  for (int i = 0; i < 60; ++i) {
    const double mid = 0.5 * (lo + hi);
    (excess(mid) > 0.0 ? lo : hi) = mid;
  }
  return 0.5 * (lo + hi);
}

int ChernoffDraws(double epsilon, double delta) noexcept {
  return static_cast<int>(std::fmin(std::ceil(ChernoffBound(epsilon, delta)), 2e9));
}

}  // namespace armcmc
