#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace armcmc::plant_sim {

/// One signal of a plant that a file describes, with all its samples.
struct SignalSamples {
  std::string name;
  std::string unit;
  std::vector<double> value;  ///< [row] in its unit.
};

/// Samples of every signal of a plant that a file describes, at equal intervals within each run.
struct SampleRuns {
  std::string plant;                   ///< Name that the plant's file gives.
  std::uint64_t fingerprint = 0;       ///< Of the plant's signals.
  std::vector<SignalSamples> signals;  ///< In the order of the plant's file, of equal length.
  std::size_t output = 0;              ///< Among the signals.
  double dt = 0.0;                     ///< s, > 0, sample interval.
  std::vector<std::size_t> runs;       ///< First row of each run, increasing, the first is 0.

  [[nodiscard]] std::size_t num_rows() const { return signals.empty() ? 0 : signals.front().value.size(); }
  /// One past the last row of a run.
  [[nodiscard]] std::size_t RunEnd(std::size_t run) const { return run + 1 < runs.size() ? runs[run + 1] : num_rows(); }
};

}  // namespace armcmc::plant_sim
