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

/// An input of a plant, and how far and how fast a recording moved it.
struct InputRange {
  std::size_t signal = 0;
  double low = 0.0, high = 0.0;  ///< Unit of the signal; all but one percent of the rows are between.
  double rest = 0.0;             ///< Median.
  double frequency_hz = 0.0;     ///< How often it went from its lower to its upper quarter.
  double speed = 0.0;            ///< Unit per s, passed in one row of a hundred.

  [[nodiscard]] bool moved() const { return high > low; }
};

/// Signals that move by themselves: no output, no derivative, and no state that measures them or starts there.
[[nodiscard]] std::vector<std::size_t> InputsOf(const PlantDescription& plant);

/// Of every input, over the training rows.
[[nodiscard]] std::vector<InputRange> RangesOf(const Dataset& data, const PlantDescription& plant);

/// A way to move the inputs, each an expression of t (s).
struct Motion {
  std::string program;                            ///< Of the library.
  std::string words;                              ///< "in strokes at constant speed, 2 s each way"
  double pace = 1.0;                              ///< Of the library's frequencies, over that of the recording.
  InputRange moved;                               ///< The input that it is about.
  std::map<std::size_t, std::string> program_of;  ///< By input: the expression, the same as in a scenario.
};

/// The motions of the library for every input that the recording moved, within its range: with the others at rest, and,
/// where those moved, too, while they step through their ranges.
/// @param pace  Times the frequency of the recording.
[[nodiscard]] std::vector<Motion> MotionsAt(double pace, const PlantDescription& plant,
                                            const std::vector<InputRange>& ranges, double duration_s, double dt);

/// All signals of the plant in that motion; derivatives are exact. What is no input stays at `rest`.
/// @param rest  [signal]
/// @return null where a program is too large.
[[nodiscard]] std::shared_ptr<identify::Series> SeriesOf(const Motion& motion, const PlantDescription& plant,
                                                         const std::vector<double>& rest, std::size_t rows, double dt);

}  // namespace armcmc::ladder
