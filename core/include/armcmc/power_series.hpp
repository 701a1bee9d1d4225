#pragma once

#include <array>

#include "armcmc/types.hpp"

namespace armcmc {

/// The power x_n^p of a law at the samples of a pack, for exponents p near the posterior's, as polynomials:
///
///   x_n^p = 2^(p l_n) = sum_k coefficient_nk (p - middle)^k,     l_n = log2 x_n,  |p - middle| <= reach
///
/// with minimax coefficients of the exponential function, relative error below 4.1e-11. The narrower the posterior, the
/// lower the degree. The kernels fill it in and know how coefficients are laid out.
struct PowerSeries {
  static constexpr int kLeast = 3, kMost = 8;  ///< Degrees.
  static constexpr int kRun = 8;               ///< Samples that share a degree.

  int parameter = -1;  ///< That is the exponent; -1: the law has no such power, and nothing else is set.
  double middle = 0.0, reach = 0.0;
  std::array<int, kMaxPackSamples / kRun> degree{};  ///< 0: no polynomial, the power itself.
  // The stride is not a power of two, for the cache.
  alignas(64) std::array<std::array<double, 2 * kMaxPackSamples + 8>, kMost + 1> coefficient{};
};

}  // namespace armcmc
