#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace armcmc::support {

/// One signal of a plant over a recording.
struct RecordedSignal {
  std::string name;
  std::string unit;
  std::vector<double> value;  ///< [row]
};

/// What somebody else reports of the same data, to be shown beside our numbers.
struct PublishedFigure {
  std::string what;
  double value = 0.0;
  std::string source;
};

/// Measured data of a plant, as a recording file describes them: every signal of the plant, in its units, at equal
/// intervals within each run.
struct Recording {
  std::string title;
  std::vector<std::filesystem::path> files;  ///< That the samples came from.
  std::string model;                         ///< Name of a plant that came with the product, or path of a plant file.
  std::string plant;                         ///< Name that the plant file gives.
  std::uint64_t fingerprint = 0;             ///< Of the plant's signals.
  std::vector<RecordedSignal> signals;       ///< In the order of the plant file.
  std::size_t output = 0;                    ///< Among the signals.
  double dt = 0.0;                           ///< s, sample interval.
  std::vector<double> t;                     ///< [row] s, increasing within a run.
  std::vector<std::size_t> runs;       ///< First row of every run: neither states nor derivatives are carried across.
  std::vector<std::uint8_t> held_out;  ///< [row] 1: held out, to validate a model.
  /// If the output was filtered here, the standard deviation of the noise that passed the filter; otherwise 0.
  double smoothed_noise = 0.0;
  /// If samples were interpolated because time was uneven, for white noise of standard deviation 1 on the rows of the
  /// file: the standard deviation of the noise of the samples, and the estimate of it from their third differences,
  /// which is too small since neighbours share noise. Otherwise 1.
  double noise_in_samples = 1.0, noise_in_differences = 1.0;
  std::vector<PublishedFigure> published;
  std::vector<std::string> notes;  ///< For the user: what was derived, resampled, left out.

  [[nodiscard]] std::size_t num_rows() const { return t.size(); }
};

/// Name or path of the plant that a recording file belongs to; a path is relative to the recording file.
/// @throws ConfigError.
[[nodiscard]] std::string RecordingModel(const std::filesystem::path& recording);

/// Reads a recording file and its CSV.
/// @param data_dir  Where the CSV is if it is not beside the recording file; may be empty.
/// @throws ConfigError naming file, line, column and key; InputError naming file and line of the CSV.
[[nodiscard]] Recording ReadRecording(const std::filesystem::path& recording, const std::filesystem::path& data_dir);

/// Reads a CSV whose columns are called `t` and as the signals of the plant.
/// @param model  Name of a plant that came with the product, or path of a plant file.
/// @param skip_bad  Count and skip bad rows; otherwise the first one is an error.
[[nodiscard]] Recording ReadRecordedCsv(const std::filesystem::path& csv, const std::string& model, bool skip_bad);

/// Two recordings of one plant as the runs of one, so that a law has the same parameters in both. Each keeps its rows
/// apart as it did; notes, title and published figures are those of the later one.
/// @throws InputError where they are of different plants or rates.
[[nodiscard]] Recording Joined(const Recording& earlier, const Recording& later);

}  // namespace armcmc::support
