#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/identify/trajectory_model.hpp"
#include "armcmc/ladder/dataset.hpp"
#include "armcmc/plant/plant.hpp"

namespace armcmc::ladder {

/// An input of a plant, with the range and speed at which a recording moved it.
struct InputRange {
  std::size_t signal = 0;
  double low = 0.0, high = 0.0;  ///< Unit of the signal; 99 % of the rows are in this range.
  double rest = 0.0;             ///< Median.
  double frequency_hz = 0.0;     ///< Rate of passages from the lower to the upper quartile.
  double speed = 0.0;            ///< 99th percentile of the speed, unit per s.

  [[nodiscard]] bool moved() const { return high > low; }
};

/// Signals that can be moved freely: neither the output, nor a derivative, nor a signal that measures a state or at
/// which a state starts.
[[nodiscard]] std::vector<std::size_t> InputsOf(const PlantDescription& plant);

/// Ranges of all inputs, over the training rows.
[[nodiscard]] std::vector<InputRange> RangesOf(const Dataset& data, const PlantDescription& plant);

/// A motion of the inputs, each given as an expression of t (s).
struct Motion {
  std::string program;                            ///< Name in the library.
  std::string words;                              ///< "in strokes at constant speed, 2 s each way"
  double pace = 1.0;                              ///< Its frequency relative to that of the recording.
  InputRange moved;                               ///< The input that is moved.
  std::map<std::size_t, std::string> program_of;  ///< [input] Expression, as in a scenario.
};

/// The motions of the library for every input that the recording moved, within its range: with the other inputs at
/// rest, and, if those moved too, while they step through their ranges.
/// @param pace  Relative to the frequency of the recording.
[[nodiscard]] std::vector<Motion> MotionsAt(double pace, const PlantDescription& plant,
                                            const std::vector<InputRange>& ranges, double duration_s, double dt);

/// All signals of the plant in that motion, with exact derivatives. Signals that are not inputs stay at `rest`.
/// @param rest  [signal] Resting values.
/// @return null if an expression is too large.
[[nodiscard]] std::shared_ptr<identify::Series> SeriesOf(const Motion& motion, const PlantDescription& plant,
                                                         const std::vector<double>& rest, std::size_t rows, double dt);

}  // namespace armcmc::ladder
