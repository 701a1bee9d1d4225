#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// Distribution of a parameter that is a mixture of at most `kMost` normal laws, F(x) = sum_i p_i Phi((x - m_i) / s_i),
/// of which those with a small share (kSmall) count as one with their mean and variance.
template <std::size_t kMost>
class NormalMixture {
 public:
  /// @param share     p_i; all of them sum to 1. Without one, or a negative one, nothing is added.
  /// @param variance  s_i^2 > 0. @pre At most kMost were added before. @rt O(1).
  void Add(double share, double mean, double variance) noexcept ARMCMC_NONBLOCKING {
    if (!(share > 0.0)) return;
    if (share >= kSmall) {
      laws_[count_++] = {share, mean, std::sqrt(variance)};
      return;
    }
    // By West's recursion, which cancels nothing.
    const double sum = small_.share + share;
    const double apart = mean - small_.mean;
    square_ += share * (variance + apart * apart * small_.share / sum);
    small_ = {sum, small_.mean + apart * share / sum, 0.0};
    small_.sd = std::sqrt(square_ / sum);
  }

  /// @param p  In (0, 1).
  /// @param z  The point at which the standard normal law has it, Phi(z) = p.
  /// @return x with F(x) = p, to about a thousandth of the standard deviation there; NaN without a law.
  /// @rt No heap, no lock, no throw. At most kIterations times the number of laws.
  [[nodiscard]] double Quantile(double p, double z) const noexcept ARMCMC_NONBLOCKING {
    // That of a mixture lies between those of its laws.
    double lo = HUGE_VAL;
    double hi = -HUGE_VAL;
    double at = 0.0;
    ForEach([&](const Law& law) noexcept ARMCMC_NONBLOCKING {
      const double own = law.mean + z * law.sd;
      lo = std::fmin(lo, own);
      hi = std::fmax(hi, own);
      at += law.share * own;
    });
    if (!(lo <= hi)) return std::nan("");
    at = std::clamp(at, lo, hi);
    // Newton's method, and halving where that leaves the interval in which the solution is.
    const double tolerance = kTolerance * std::fmin(p, 1.0 - p);
    for (int k = 0; k < kIterations && lo < hi; ++k) {
      double above = -p;
      double density = 0.0;
      ForEach([&](const Law& law) noexcept ARMCMC_NONBLOCKING {
        const double apart = (at - law.mean) / law.sd;
        above += law.share * 0.5 * std::erfc(-apart / std::numbers::sqrt2);
        density += law.share / law.sd * std::exp(-0.5 * apart * apart);
      });
      (above < 0.0 ? lo : hi) = at;
      const double next = at - above * std::sqrt(2.0 * std::numbers::pi) / density;
      if (std::fabs(above) < tolerance) return std::clamp(next, lo, hi);
      at = next > lo && next < hi ? next : 0.5 * (lo + hi);
    }
    return at;
  }

 private:
  static constexpr double kSmall = 0.002;
  static constexpr double kTolerance = 0.05;
  static constexpr int kIterations = 20;
  struct Law {
    double share, mean, sd;
  };
  template <typename Use>
  void ForEach(const Use& use) const noexcept ARMCMC_NONBLOCKING {
    for (std::size_t i = 0; i < count_; ++i) use(laws_[i]);
    if (small_.share > 0.0) use(small_);
  }

  std::array<Law, kMost> laws_{};
  std::size_t count_ = 0;
  Law small_{0.0, 0.0, 1.0};
  double square_ = 0.0;  ///< Sum of the shares times the squares of the distances from the mean of the small ones.
};

}  // namespace armcmc
