#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "armcmc/identify/trajectory_model.hpp"
#include "armcmc/plant/effect_scales.hpp"
#include "armcmc/plant/plant.hpp"
#include "armcmc/support/recording.hpp"

namespace armcmc::ladder {

/// A recording and which of its rows may be looked at.
struct Dataset {
  std::shared_ptr<const identify::Series> series;  ///< All rows.
  std::vector<std::uint8_t> training;              ///< [row] 1: models are fitted to it.
  std::vector<std::uint8_t> held_out;              ///< [row] 1: kept apart to the end.

  [[nodiscard]] std::size_t num_training() const;
};

/// All rows, with what the recording keeps apart.
[[nodiscard]] Dataset DatasetOf(const support::Recording& recording);

/// What is left of each run up to its last training row, and of that `rows` at most: the beginning of every run, in
/// proportion to its length. Nothing is held out in it.
[[nodiscard]] Dataset Beginnings(const Dataset& data, std::size_t rows);

/// Short stretches, each a run of its own: half of them all over the data, half where errors are largest.
/// @param error   [row] Of a model, unit of what is explained; empty: all over the data.
/// @param length  Rows of a stretch; neighbours are joined. About `rows` together.
[[nodiscard]] Dataset Windows(const Dataset& data, const Eigen::VectorXd& error, std::size_t length, std::size_t rows);

/// Sizes of the training rows, for the priors of effects.
/// @param noise  Standard deviation, unit of what is explained.
[[nodiscard]] DataScales ScalesOf(const Dataset& data, const PlantDescription& plant, double noise);

/// Standard deviation of what changes from sample to sample: of third differences of the target, which a smooth signal
/// does not have (each has the variance 20 s^2 for independent errors s). Too large where the signal itself is not
/// smooth at the sampling rate, too small where it was filtered.
/// @param target  [row] What the law explains.
/// @param active  [row] 1: a mode acts.
[[nodiscard]] double NoiseFloor(const Dataset& data, const Eigen::VectorXd& target,
                                const std::vector<std::uint8_t>& active);

}  // namespace armcmc::ladder
