#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/settings.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::replay {

/// Predictions of the estimator for every sample of a recording, made before it saw the pack.
struct Course {
  double pack_s = 0.0;  ///< Length of a pack: the horizon of a prediction.
  /// [row of the recording] Measured minus predicted, and half the width of the 95 % prediction interval; NaN where
  /// nothing was predicted.
  std::vector<double> error, half_width;
};

/// Runs the estimator over the packs of a recording of a described plant.
///
/// The 95 % interval of a sample is sqrt((1.96 sd)^2 + (q noise)^2) to either side, sd that of PackForecast and q the
/// 97.5 % quantile of the noise's law with scale 1.
/// @param samples_per_pack  0: as when the recording is played onto a bus.
/// @param progress  Share done; may be empty.
/// @throws support::InputError where no run fills a pack, std::invalid_argument where the settings are wrong.
[[nodiscard]] Course PredictPackAhead(const EstimatorSettings& settings,
                                      const std::shared_ptr<const support::Recording>& recording, int samples_per_pack,
                                      const std::function<void(double share)>& progress);

/// 97.5 % quantile of a law of scale 1 and mean 0.
[[nodiscard]] double UpperQuantile(const NoiseSettings& noise);

}  // namespace armcmc::replay
