#pragma once

#include <cstddef>
#include <vector>

#include "armcmc/estimate.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::calibrate {

/// Smallest threshold that is proposed: a change below a tenth of the noise is not worth forgetting the past for.
inline constexpr double kSmallestThreshold = 0.1;

/// The threshold at which a pack would just have been taken for a change:
///
///   score = sqrt(share) (excess - allowance),   share: samples of the mode over those of the pack
///
/// excess is |zeta - mu| for signed_mean and zeta - mu for the other indices. A pack is a modification when its score
/// reaches forgetting.threshold (core/include/armcmc/forgetting.hpp).
/// @param settings  Of the run, whose threshold was never reached.
[[nodiscard]] double ThresholdScore(const ForgettingSettings& settings, const ModeEstimate& mode, int pack_samples);

/// A threshold and what it was taken from.
struct ThresholdChoice {
  double threshold = 1.0;
  double measured_rate = 0.0;  ///< Share of the scores that reach it.
  bool extrapolated = false;   ///< Beyond what the data show: from an exponential tail.
  bool at_floor = false;       ///< kSmallestThreshold already gives a smaller rate than requested.
};

/// The threshold that a share `rate` of packs reaches although nothing changed.
///
/// With ten or more scores expected above it, the empirical quantile; else an exponential tail fitted to the largest
/// tenth of the scores (at least 20): u + mean excess over u x log(share above u / rate).
/// @pre At least 20 scores, 0 < rate < 1.
[[nodiscard]] ThresholdChoice ChooseThreshold(std::vector<double> scores, double rate);

}  // namespace armcmc::calibrate
