#pragma once

#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

/// Savitzky-Golay: the value (derivative = 0) or slope per sample (1) of the least-squares cubic through the `window`
/// samples around each sample; at the ends, of the outermost window.
/// @param window  Odd. Below 5 the series is returned as it is, or its central difference.
[[nodiscard]] Vector SavitzkyGolay(const Vector& series, int window, int derivative);

/// The widest window up to `widest` that removes noise from a series but not motion: it removes no more than it would
/// from white noise with the level of the fourth differences. 1: every window would remove motion.
[[nodiscard]] int WidestWindow(const Vector& series, int widest);

/// Low pass of u(t) with time constant `tau_samples`, started at `start` times its first value.
[[nodiscard]] Vector Leaky(const Vector& series, double tau_samples, double start = 1.0);

}  // namespace armcmc::gap
