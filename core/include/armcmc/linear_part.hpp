#pragma once

#include <array>

#include "armcmc/types.hpp"

namespace armcmc {

/// The parameters in which the law of a mode is linear, given the others:
///
///     F(X, theta) = f_0(X, phi) + sum_i theta_i f_i(X, phi)       i in `linear`, phi the rest
///
/// Known only where phi is one parameter at most.
struct LinearPart {
  std::array<int, kMaxParams> linear{};
  int num_linear = 0;  ///< 0: not known to be linear in any.
  int curved = -1;     ///< The other parameter; -1: there is none.
};

}  // namespace armcmc
