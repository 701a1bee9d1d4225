#pragma once

#include <array>

#include "armcmc/plant/state_run.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

/// What the uncertain start of a pack's states does to its errors, as the scoring kernels take it into account.
///
/// With the start x ~ N(x0, s^2 P) and the law's linear response S to it, the errors of a candidate have the covariance
/// s^2 (I + S P S') instead of s^2 I. `direction` are the orthonormal u_j of S P S' = sum_j l_j u_j u_j', and
///
///   e <- e - sum_j (1 - 1 / sqrt(1 + l_j)) u_j (u_j' e)
///
/// makes them independent again, of variance s^2.
///
/// Where the pack before ended depends on the parameters that it is thought to have had: other ones would have ended
/// elsewhere, and say the same of the data so far. So a candidate starts at x0 + sum_d slope_d h(theta_d - about_d),
/// h(x) = x up to `reach`, and falling back to 0 at twice that: parameters that far away were different ones then.
struct StartFit {
  std::array<double, kMaxStates>
      shift{};             ///< Of a pack that continues no other: added to the start that the file gives.
  int num_parameters = 0;  ///< 0: every candidate starts alike.
  std::array<std::array<double, kMaxParams>, kMaxStates> slope{};  ///< d x0_s / d theta_d.
  std::array<double, kMaxParams> about{}, reach{};
  int count = 0;
  std::array<double, kMaxStates> shrink{};                                ///< 1 - 1 / sqrt(1 + l_j), in [0, 1).
  std::array<std::array<double, kMaxPackSamples>, kMaxStates> direction;  ///< [j][sample of the mode].
};

}  // namespace armcmc
