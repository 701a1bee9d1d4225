#pragma once

#include <optional>

#include "armcmc/gap/whitener.hpp"

namespace armcmc::gap {

/// Noise model from the frequencies above the band of the law.
///
/// What a model leaves at the frequencies of the motion is noise and misfit; above the band of the law it is noise
/// alone. An autoregressive model of order at most two is fitted there by Whittle's likelihood, and extrapolated:
/// -ln L = sum_j (ln S_j + I_j / S_j) over the frequencies j of the band, S_j = s^2 / |1 - sum_k phi_k exp(-i w_j
/// k)|^2.
/// @param residual   Of a flexible model. [row]
/// @param predicted  By the law. [row]
/// @return no model if the law is present at most frequencies, or there are too few rows.
[[nodiscard]] std::optional<Whitener> NoiseAboveBand(const Vector& residual, const Vector& predicted);

}  // namespace armcmc::gap
