#pragma once

#include <cstddef>
#include <vector>

namespace armcmc::support {

/// Low pass without delay: a Butterworth filter of order 2 forward and backward, so order 4 in magnitude and -3 dB at
/// the bandwidth. Beyond its ends a series goes on as the polynomial of degree 4 that fits its last period of the
/// bandwidth: a reflection would have no curvature there, so that second derivatives near the ends would be wrong by
/// their whole size.
/// @param bandwidth_hz  Above 0; at half the sample rate and above nothing is changed.
[[nodiscard]] std::vector<double> ZeroPhase(const std::vector<double>& x, double dt, double bandwidth_hz);

/// Derivative by central differences of order 4, at the two outermost samples of order 2 and one-sided of order 2.
/// @pre At least 5 samples.
[[nodiscard]] std::vector<double> Derivative(const std::vector<double>& x, double dt);

/// The smallest bandwidth, Hz, whose filter leaves out no more than the noise: the standard deviation of what it takes
/// away is at most 1.5 times that of white noise as the third differences of the signal show it.
[[nodiscard]] double SuitableBandwidth(const std::vector<double>& x, double dt);

}  // namespace armcmc::support
