#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "armcmc/linear_part.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

/// sum_kl coefficient[k][l] T_k(t_0) T_l(t_1), k < num_rows, l <= degree[k].
struct ProductSeries {
  static constexpr int kMaxDegree = 23;  ///< Largest k + l.

  int num_rows = 0;
  std::array<int, kMaxDegree + 1> degree{};  ///< Odd.
  alignas(64) std::array<std::array<double, kMaxDegree + 1>, kMaxDegree + 1> coefficient{};
};

/// The sum of squared errors of a pack where the law has a LinearPart, as a function of the standardised coordinates:
///
///   S(u) = c(t) + sum_i d_i (b_i(t) + sum_{j >= i} a_ij(t) d_j),     d_i = u_i - about_i,  i, j linear
///   t_a = clamp(slope_a u_a + origin_a, -1, 1),                      a a curved parameter, of which there are two at
///   most
///
/// c, b, a are constants, Chebyshev series of one t_a, or ProductSeries of both.
struct QuadraticForm {
  static constexpr int kMaxDegree = 47;
  /// c, every b_i and every a_ij.
  [[nodiscard]] static constexpr int Functions(int num_linear) noexcept {
    return 1 + num_linear + num_linear * (num_linear + 1) / 2;
  }
  static constexpr std::size_t kMaxFunctions = 1 + kMaxParams + kMaxParams * (kMaxParams + 1) / 2;
  static constexpr int kMaxCurved = 2;

  /// Where t_a comes from.
  struct Axis {
    int parameter = -1;
    double slope = 0.0, origin = 0.0;
    int degree = 0;  ///< Largest of any series; odd.
  };

  int num_linear = 0;
  std::array<int, kMaxParams> linear{};
  std::array<double, kMaxParams> about{};
  int num_curved = 0;
  std::array<Axis, kMaxCurved> axis{};
  /// Of c, then for every i of b_i and of a_ij for j from i on.
  std::array<LinearPart::Need, kMaxFunctions> needs{};
  std::array<int, kMaxFunctions> degree{};  ///< Of a series of one t: odd.
  /// Factor k of T_k at [k]; of a constant only the first.
  alignas(64) std::array<std::array<double, kMaxDegree + 1>, kMaxFunctions> coefficient{};
  std::vector<ProductSeries> product;  ///< Of the functions that need both, in their order.
  /// Sums of the errors with the levers of a DriftFactor, l_m(u) = e_m(t) + sum_i s_mi(t) d_i, each a series of one t
  /// at most: for every lever of e_m, then of s_mi for every i.
  int num_levers = 0;
  std::array<LinearPart::Need, kMaxParams + 1> lever_needs{};  ///< Of e_m, then of s_mi; the same for every lever.
  alignas(64) std::array<std::array<double, kMaxDegree + 1>, kMaxFunctions> lever{};
};

}  // namespace armcmc
