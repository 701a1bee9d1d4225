#pragma once

#include "armcmc/gap/types.hpp"

namespace armcmc::gap {

/// Savitzky-Golay: the value (derivative = 0) or slope per sample (1) of the cubic that fits the `window` samples
/// around each sample best; at the ends the cubic of the outermost window.
/// @param window  Odd. Below 5 the series is returned as it is, or its central difference.
[[nodiscard]] Vector SavitzkyGolay(const Vector& series, int window, int derivative);

/// The widest window up to `widest` that takes noise off a series and leaves its motion alone: what it removes is no
/// more than what white noise of the level of the fourth differences would lose. 1: any window would blur.
[[nodiscard]] int WidestWindow(const Vector& series, int widest);

/// u(t) through a low pass of time constant `tau_samples`, started at `start` times its first value.
[[nodiscard]] Vector Leaky(const Vector& series, double tau_samples, double start = 1.0);

}  // namespace armcmc::gap
