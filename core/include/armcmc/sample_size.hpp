#pragma once

#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// Chernoff number of draws, log(2 / (1 - delta)) / (2 epsilon^2) (equation `chern`); not rounded.
[[nodiscard]] double ChernoffBound(double epsilon, double delta) noexcept ARMCMC_NONBLOCKING;

/// The bound as a number of draws, rounded up: 14 979 for epsilon = 0.01, delta = 0.9.
[[nodiscard]] int ChernoffDraws(double epsilon, double delta) noexcept ARMCMC_NONBLOCKING;

/// Minimum number of draws at forgetting factor lambda: the root k of equation `neval`,
///
///   k = 1 / (2 eps^2) log( 2 / (lambda (1 - delta) + 2 (1 - lambda) exp(-2 eps^2 (1 - lambda) k)) ).
///
/// The right side minus k falls from positive at k = 0 to negative at the Chernoff number for lambda in (0, 1), so
/// the root is unique and bisection finds it (60 halvings at most). At lambda = 1 it is the Chernoff number; at
/// lambda = 0 every k solves the relation, and the Chernoff number is returned.
/// @param lambda   In [0, 1]; values outside are clamped.
/// @rt No heap, no lock, no throw. At most 60 iterations.
[[nodiscard]] double MinimumDraws(double lambda, double epsilon, double delta) noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc
