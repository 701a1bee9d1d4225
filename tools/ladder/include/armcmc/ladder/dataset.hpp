#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "armcmc/identify/trajectory_model.hpp"
#include "armcmc/plant/effect_scales.hpp"
#include "armcmc/plant/plant.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::ladder {

/// A recording, with the roles of its rows.
struct Dataset {
  std::shared_ptr<const identify::Series> series;  ///< All rows.
  std::vector<std::uint8_t> training;              ///< [row] 1: used for fitting.
  std::vector<std::uint8_t> held_out;              ///< [row] 1: held out until the end.

  [[nodiscard]] std::size_t num_training() const;
};

/// All rows of a recording, with its held-out rows marked.
[[nodiscard]] Dataset DatasetOf(const support::Recording& recording);

/// The beginning of every run, in proportion to its length up to its last training row, `rows` rows at most in total.
/// Nothing is held out.
[[nodiscard]] Dataset Beginnings(const Dataset& data, std::size_t rows);

/// Short segments, each a run of its own: half of them spread over the data, half where the errors are largest.
/// @param error   [row] Error of a model, unit of the explained quantity; empty: all segments are spread over the data.
/// @param length  Rows of a segment; adjacent segments are joined.
/// @param rows    Approximate total number of rows.
[[nodiscard]] Dataset Windows(const Dataset& data, const Eigen::VectorXd& error, std::size_t length, std::size_t rows);

/// Typical sizes of the signals on the training rows, which scale the priors of effects.
/// @param noise  Standard deviation of the noise, unit of the explained quantity.
[[nodiscard]] DataScales ScalesOf(const Dataset& data, const PlantDescription& plant, double noise);

/// Standard deviation of the noise, estimated from third differences of the target. A smooth signal has none; those of
/// independent errors with standard deviation s have the variance 20 s^2. Too large if the signal itself is not smooth
/// at the sampling rate, too small if it was filtered.
/// @param target  [row] Quantity that the law explains.
/// @param active  [row] 1: a mode acts.
[[nodiscard]] double NoiseFloor(const Dataset& data, const Eigen::VectorXd& target,
                                const std::vector<std::uint8_t>& active);

}  // namespace armcmc::ladder
