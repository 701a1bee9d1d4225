#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "armcmc/plant/description.hpp"
#include "recording_file.hpp"

namespace armcmc::support {

/// The rows of a CSV that a recording uses, before anything is filtered or resampled.
struct RecordingRows {
  std::vector<double> t;                    ///< s
  std::vector<std::vector<double>> signal;  ///< [signal of the plant][row]; empty: the file lacks it.
  std::vector<std::uint8_t> new_run;        ///< [row] 1: another segment than the row before, or rows are left out.
  std::vector<std::uint8_t> held_out;       ///< [row]
  std::size_t skipped = 0;                  ///< Bad rows.
  std::size_t in_file = 0;                  ///< Rows of the CSV, used or not.
  std::vector<std::string> notes;           ///< For the user: changes of times and blank cells.

  [[nodiscard]] std::size_t size() const { return t.size(); }
  /// Puts other rows behind these, as runs of their own.
  void Append(const RecordingRows& other);
};

/// Reads one record of a recording file.
/// @param csv      To read.
/// @param sources  Of the signals; of one that it lacks, the column of the signal's name.
/// @param name     Of the recording file, for messages.
/// @throws InputError, ConfigError.
[[nodiscard]] RecordingRows ReadRecordingRows(const std::filesystem::path& csv, const RecordingFile& file,
                                              const std::map<std::string, ColumnSource>& sources,
                                              const PlantDescription& plant, const std::string& name, bool skip_bad);

}  // namespace armcmc::support
