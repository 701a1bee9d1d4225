#pragma once

#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

/// Root mean square of a series, over rows of weight one; 0 where there are none.
[[nodiscard]] double RootMeanSquare(const Vector& series, const Vector& weight);
/// Of all rows.
[[nodiscard]] double RootMeanSquare(const Vector& series);
/// The element below which a share q of the others lies, 0 <= q <= 1. @pre The series is not empty.
[[nodiscard]] double Quantile(const Vector& series, double q);
/// Whether a series differs from a constant by more than rounding.
[[nodiscard]] bool Moves(const Vector& series);

}  // namespace armcmc::gap
