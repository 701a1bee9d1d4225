#pragma once

#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

/// X'X of the rows [first, first + rows) of X. Sums in an order that no processor changes. Not real-time.
[[nodiscard]] Matrix GramOf(const Matrix& x, Eigen::Index first, Eigen::Index rows);

}  // namespace armcmc::gap
