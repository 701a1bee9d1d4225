#pragma once

#include <array>
#include <cstddef>

#include "armcmc/types.hpp"

namespace armcmc {

/// The sum of squared errors of a pack where the law has a LinearPart, as a function of the standardised coordinates:
///
///   S(u) = c(t) + sum_i d_i (b_i(t) + sum_{j >= i} a_ij(t) d_j),     d_i = u_i - about_i,  i, j linear
///   t = clamp(slope u_curved + origin, -1, 1)
///
/// c, b, a are Chebyshev series of t, or constants where no parameter is curved.
struct QuadraticForm {
  static constexpr int kMaxDegree = 47;
  /// c, every b_i and every a_ij.
  [[nodiscard]] static constexpr int Functions(int num_linear) noexcept {
    return 1 + num_linear + num_linear * (num_linear + 1) / 2;
  }
  static constexpr std::size_t kMaxFunctions = 1 + kMaxParams + kMaxParams * (kMaxParams + 1) / 2;

  int num_linear = 0;
  std::array<int, kMaxParams> linear{};
  std::array<double, kMaxParams> about{};
  int curved = -1;
  double slope = 0.0, origin = 0.0;
  int degree = 0;  ///< 0, or odd.
  /// Of c, then for every i of b_i and of a_ij for j from i on: factor k of T_k at [k].
  alignas(64) std::array<std::array<double, kMaxDegree + 1>, kMaxFunctions> coefficient{};
  /// Sums of the errors with the levers of a DriftFactor, l_m(u) = e_m(t) + sum_i s_mi(t) d_i: for every lever of e_m,
  /// then of s_mi for every i.
  int num_levers = 0;
  alignas(64) std::array<std::array<double, kMaxDegree + 1>, kMaxFunctions> lever{};
};

}  // namespace armcmc
