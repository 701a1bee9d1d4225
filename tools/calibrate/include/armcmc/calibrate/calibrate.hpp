#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/calibrate/noise_fit.hpp"
#include "armcmc/calibrate/threshold.hpp"
#include "armcmc/replay/pack_source.hpp"
#include "armcmc/settings.hpp"

namespace armcmc::calibrate {

/// What to calibrate from.
struct CalibrationRequest {
  EstimatorSettings settings;         ///< Where to begin.
  double false_modifications = 1e-3;  ///< Share of packs that may be taken for a change although nothing changed.
  std::function<std::unique_ptr<replay::PackSource>()> open;  ///< The recording of normal operation, from its start.
  std::function<void(double)> on_progress = [](double) {};
};

/// The noise of one mode.
struct ModeNoise {
  std::string mode;
  bool calibrated = false;
  std::string why_not;  ///< Too few packs, or no noise.
  std::size_t packs = 0, samples = 0;
  std::vector<LawScore> laws;
  std::size_t chosen = 0;
  double correlation = 0.0;    ///< Of an error with the next.
  std::vector<double> errors;  ///< For plots, thinned.
};

/// One value of rho on trial.
struct RhoScore {
  double rho = 0.0;
  double ahead = 0.0;  ///< Mean log density of each pack under the estimates before it, nats a sample.
  double behind = 0.0, behind_se = 0.0;  ///< What it lacks to the best, and its standard error over packs.
};

/// Mismatch of one pack and mode in the last run.
struct ThresholdSample {
  double t = 0.0, score = 0.0;
};

struct Calibration {
  EstimatorSettings settings;  ///< Calibrated.
  std::vector<ModeNoise> noise;
  int noise_runs = 0;         ///< Runs until law and scale stood still.
  std::vector<RhoScore> rho;  ///< Empty: not tried, the model has effects.
  std::vector<ThresholdSample> scores;
  ThresholdChoice threshold;
  double false_modifications = 0.0;  ///< As asked.
  std::vector<std::string> notes;    ///< What a person should know.
};

/// Noise law and scale, rho and zeta_th from a recording in which nothing changed (the paper's Remark 2).
///
/// 1. Noise: errors of every pack under the estimate after it, in the unit of the regression target, give law and scale
///    (CompareLaws); the estimator runs again with them until they stand still.
/// 2. rho: the smallest of a grid whose estimates predict the next pack as well as the best, within two standard
/// errors.
/// 3. zeta_th: the score that a share `false_modifications` of packs reaches (ThresholdScore).
/// The runs of 1 and 2 take no pack for a modification; those of 3 do, as the estimator will.
/// @throws support::InputError when the recording is too short.
[[nodiscard]] Calibration Calibrate(const CalibrationRequest& request);
inline constexpr std::size_t kMinPacks = 40;  ///< Of a mode, informative.

}  // namespace armcmc::calibrate
