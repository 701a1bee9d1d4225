#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>

namespace armcmc::tables {

/// Levels of the credible intervals that are judged, and half their widths in standard deviations of a normal law.
inline constexpr std::array<double, 3> kLevels{0.5, 0.9, 0.95};
inline constexpr std::array<double, 3> kHalfWidths{0.674489750196082, 1.644853626951473, 1.959963984540054};

/// Variance of the share of a run's packs whose intervals hold the truth, when the intervals are right.
///
/// The packs of one run share their data, so that a run is a few decisions and not as many as it has packs; and the
/// spread between runs is uninformative when all of them cover. What the spread has to be follows from the posteriors:
/// let e_j be the error of the posterior mean after pack j and s_j its standard deviation. The later of two estimates,
/// k > j, has used all that the earlier one knew, hence e_k is uncorrelated with the correction e_j - e_k, hence
///
///   cov(e_j, e_k) = s_k^2,   r_jk = corr(e_j / s_j, e_k / s_k) = s_k / s_j.
///
/// With errors from a normal law, the interval of level L covers where |e / s| < c, and
///
///   cov(covers_j, covers_k) = P(|z_j| < c, |z_k| < c) - L^2
///                           = 1/pi int_0^asin(r) exp(-c^2 / (1 + sin t)) - exp(-c^2 / (1 - sin t)) dt      (Plackett)
///
/// which is 0 for r = 0 and L (1 - L) for r = 1. The variance is the mean of that over all pairs of packs. For a method
/// that forgets (or learns from one pack alone) the packs depend on each other less, and this is an upper bound.
///
/// @param sd     Posterior standard deviations of one parameter after each pack that is counted, >= 0.
/// @param level  Index into kLevels.
[[nodiscard]] double NullCoverageVariance(std::span<const double> sd, std::size_t level);

/// What a measured coverage says about the intervals.
enum class Calibration { kAsStated, kTooNarrow, kTooWide };

/// kAsStated within two standard errors of the level.
[[nodiscard]] Calibration JudgeCoverage(double coverage, std::size_t level, double standard_error);

/// "as stated", "too narrow" or "too wide".
[[nodiscard]] const char* NameOf(Calibration calibration);

/// In percent, followed by what is wrong, if anything: "60.6 ± 6", "86.2 ± 3.8, too narrow".
[[nodiscard]] std::string CoverageText(double coverage, std::size_t level, double standard_error);

}  // namespace armcmc::tables
