#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "armcmc/settings.hpp"

namespace armcmc::calibrate {

/// Errors of one mode, pack after pack.
using PackErrors = std::vector<std::vector<double>>;

/// Maximum likelihood of one law for errors around zero: its scale, and its shape where it has one.
///
///   Gaussian  s^2 = mean e^2          Laplace  s = mean |e|
///   Student-t EM for the scale, golden section for log dof in [1, 200]
///   Mixture   EM for weight [1e-3, 0.5], scale and outlier scale [1.5, 100], the best of several starts
///
/// @param start  Keeps what is not estimated (mean, estimate_std).
/// @pre errors has a value that is not zero.
[[nodiscard]] NoiseSettings FitLaw(NoiseKind kind, const std::vector<double>& errors, const NoiseSettings& start);

/// One law on trial.
struct LawScore {
  NoiseSettings noise;     ///< Fitted to all errors.
  double heldout = 0.0;    ///< Mean log density of errors that had no part in its fit, nats a sample.
  double behind = 0.0;     ///< What it lacks to the best law, >= 0.
  double behind_se = 0.0;  ///< Standard error of that, over blocks of packs.
};

/// Every law, fitted to every second block of packs and scored on the others, and the other way round; in order of
/// complexity.
/// @pre At least two packs with errors that are not all zero.
[[nodiscard]] std::vector<LawScore> CompareLaws(const PackErrors& errors, const NoiseSettings& start);

/// The simplest law that is within two standard errors of the best.
[[nodiscard]] std::size_t SimplestGoodLaw(const std::vector<LawScore>& scores);

/// "gaussian", as in a configuration.
[[nodiscard]] std::string_view Name(NoiseKind kind);

/// Correlation of an error with the next one, in [-1, 1]: laws of independent noise know none.
[[nodiscard]] double Lag1Correlation(const PackErrors& errors);

}  // namespace armcmc::calibrate
