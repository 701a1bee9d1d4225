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
      laws_[count_++] = Of(share, mean, std::sqrt(variance));
      return;
    }
    // By West's recursion, which cancels nothing.
    const double sum = small_.share + share;
    const double apart = mean - small_.mean;
    square_ += share * (variance + apart * apart * small_.share / sum);
    small_ = Of(sum, small_.mean + apart * share / sum, std::sqrt(square_ / sum));
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
    // Newton's method for the log of the smaller tail, which is concave, and halving where that leaves the interval in
    // which the solution is.
    const double side = z < 0.0 ? 1.0 : -1.0;
    const double tail = std::fmin(p, 1.0 - p);
    for (int k = 0; k < kIterations && lo < hi; ++k) {
      double beyond = 0.0;
      double density = 0.0;
      ForEach([&](const Law& law) noexcept ARMCMC_NONBLOCKING {
        const double apart = side * (at - law.mean) * law.per_sd;
        const double height = std::exp(-0.5 * apart * apart);
        const double outside = height * MillsRatio(std::fabs(apart));
        beyond += law.share * (apart < 0.0 ? outside : 1.0 - outside);
        density += law.peak * height;
      });
      ((beyond < tail) == (side > 0.0) ? lo : hi) = at;
      const double next = at - side * std::log(beyond / tail) * beyond / density;
      if (std::fabs(beyond - tail) < kTolerance * tail) return std::clamp(next, lo, hi);
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
    double per_sd, peak;  ///< 1 / s_i, and the density at m_i times p_i.
  };
  static Law Of(double share, double mean, double sd) noexcept ARMCMC_NONBLOCKING {
    return {share, mean, sd, 1.0 / sd, share / (sd * std::sqrt(2.0 * std::numbers::pi))};
  }
  /// Phi(-x) exp(x^2 / 2) for x >= 0, to 7e-5 of it up to x = 3.1 and 5e-4 up to 4 (Abramowitz and Stegun, Handbook of
  /// Mathematical Functions, 26.2.17, whose polynomial has an absolute error of 7.5e-8 times that).
  static double MillsRatio(double x) noexcept ARMCMC_NONBLOCKING {
    const double t = 1.0 / (1.0 + 0.2316419 * x);
    return t * (0.127414796 + t * (-0.142248368 + t * (0.7107068705 + t * (-0.7265760135 + t * 0.5307027145))));
  }
  template <typename Use>
  void ForEach(const Use& use) const noexcept ARMCMC_NONBLOCKING {
    for (std::size_t i = 0; i < count_; ++i) use(laws_[i]);
    if (small_.share > 0.0) use(small_);
  }

  std::array<Law, kMost> laws_{};
  std::size_t count_ = 0;
  Law small_ = Of(0.0, 0.0, 1.0);
  double square_ = 0.0;  ///< Sum of the shares times the squares of the distances from the mean of the small ones.
};

}  // namespace armcmc
