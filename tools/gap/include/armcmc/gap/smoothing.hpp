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

/// Standard deviation of the white noise that SavitzkyGolay leaves of one of `noise_sd`.
[[nodiscard]] double LeftOfNoise(double noise_sd, int window);

/// Decides on which side of a surface at zero a sample lies where noise hides it: the output says it, since the sample
/// belongs to the side whose nearest sample it resembles. An output that jumps there (adhesion) would otherwise be
/// wrong by the whole jump, and that one sample would outweigh thousands.
/// @param noise_sd  Of the position. @param position  Samples within three of these take the sign of their side.
void AssignSide(const Vector& output, double noise_sd, Vector* position);

/// Low pass of u(t) with time constant `tau_samples`, started at `start` times its first value.
[[nodiscard]] Vector Leaky(const Vector& series, double tau_samples, double start = 1.0);

}  // namespace armcmc::gap
