#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// Where a parameter is at the end of a pack in which it moves, given the effective one (Drift), both in standardised
/// coordinates: u = G^-1(F(v)), if F is the distribution of the effective parameter v and G of the one at the end.
///
/// Piecewise linear between quantiles q_k of F and the same quantiles of G, and increasing; beyond the outermost with
/// one slope on both sides:
///
///   u = c + s v + sum_k b_k max(v, q_k),   within the bounds of the parameter
///
/// What the draws of a sampler have beyond F, because the law of the plant is not linear, is kept that way.
class EndOfPack {
 public:
  /// A probability p and the point z at which the standard normal law has it, Phi(z) = p.
  struct Level {
    double p, z;
  };
  /// Of the quantiles. The published ones are among them.
  static constexpr std::array<Level, 11> kLevels{{{0.001, -3.090232306167813},
                                                  {0.005, -2.575829303548901},
                                                  {0.025, -1.959963984540054},
                                                  {0.1, -1.281551565544601},
                                                  {0.25, -0.674489750196082},
                                                  {0.5, 0.0},
                                                  {0.75, 0.674489750196082},
                                                  {0.9, 1.281551565544601},
                                                  {0.975, 1.959963984540054},
                                                  {0.995, 2.575829303548901},
                                                  {0.999, 3.090232306167813}}};
  using Quantiles = std::array<double, kLevels.size()>;
  /// The slope changes at all of them.
  static constexpr std::size_t kBends = kLevels.size();

  /// The numbers of the equation.
  struct Line {
    double constant = 0.0;                       ///< c, standardised coordinates.
    double slope = 1.0;                          ///< s, below the first bend.
    std::array<double, kBends> at{}, bend{};     ///< q_k, and b_k: by how much the slope changes there.
    double lower = -HUGE_VAL, upper = HUGE_VAL;  ///< Bounds of u.
  };

  /// The parameter stays where it is.
  EndOfPack() = default;

  /// From quantiles of F to those of G.
  /// @param effective     q_k, of F; IsFinite() is false if two of them are one.
  /// @param end           Of G.
  /// @param offset        Added to all of them.
  /// @param outer_slope   Beyond the outermost ones, at least 0.
  /// @param lower, upper  Bounds of u.
  /// @rt No heap, no lock, no throw. O(1).
  EndOfPack(const Quantiles& effective, const Quantiles& end, double offset, double outer_slope, double lower,
            double upper) noexcept ARMCMC_NONBLOCKING;
  /// The slope on average between the outermost quantiles. @rt As above.
  [[nodiscard]] static double AverageSlope(const Quantiles& effective,
                                           const Quantiles& end) noexcept ARMCMC_NONBLOCKING {
    return (end.back() - end.front()) / (effective.back() - effective.front());
  }

  /// u = mean + shift + ratio (v - mean). @rt As above.
  EndOfPack(double mean, double shift, double ratio, double lower, double upper) noexcept ARMCMC_NONBLOCKING;

  /// Whether it can be used: no number of it is infinite or NaN. @rt As above.
  [[nodiscard]] bool IsFinite() const noexcept ARMCMC_NONBLOCKING;

  /// @param v  Effective parameter.
  /// @return u, that at the end of the pack.
  /// @rt No heap, no lock, no throw. O(1).
  [[nodiscard]] double operator()(double v) const noexcept ARMCMC_NONBLOCKING {
    double u = line_.constant + line_.slope * v;
    for (std::size_t k = 0; k < kBends; ++k) u += line_.bend[k] * std::max(v, line_.at[k]);
    return std::clamp(u, line_.lower, line_.upper);
  }

  /// For kernels that move many draws at a time.
  [[nodiscard]] const Line& line() const noexcept { return line_; }

 private:
  Line line_;
};

}  // namespace armcmc
