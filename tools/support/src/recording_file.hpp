#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/support/recording.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::support {

/// Where the numbers of a signal, or of the time, come from.
struct ColumnSource {
  std::string column;  ///< Of the CSV; empty: `value`.
  double scale = 1.0, offset = 0.0;
  std::string value{};                              ///< Expression of columns.
  std::optional<StrictTable> table = std::nullopt;  ///< Where it is said; none: nowhere, it is the signal's name.
  std::string key{};                                ///< Of that table.
};

/// From row `from` up to, not including, row `until`; the first row is 0.
struct RowRange {
  std::size_t from = 0, until = 0;
};

/// What is kept apart.
struct HeldOut {
  static constexpr std::size_t kToTheEnd = 1'000'000'000'000;  ///< `until` of an open range.
  bool given = false;
  std::optional<double> from_s;
  std::vector<RowRange> rows;
  std::vector<std::string> segments;
  std::string file;                             ///< Another CSV; empty: none.
  std::map<std::string, ColumnSource> columns;  ///< Of a second record; empty: as those of the first.
};

/// What becomes of rows in which a column that is read has an empty cell.
enum class BlankPolicy : std::uint8_t {
  kErrors,
  kSkipped,       ///< The rows are left out.
  kInterpolated,  ///< Rows without the output are left out; other cells are interpolated between the rows around.
};

/// A recording file as it is written.
struct RecordingFile {
  std::string title, model, file;
  std::map<std::string, ColumnSource> columns;  ///< By signal, "t" among them.
  double rate_hz = 0.0;                         ///< 0: there is a time.
  std::optional<RowRange> rows;
  std::optional<double> from_s, until_s;
  std::vector<RowRange> drop;
  std::size_t every = 1;
  BlankPolicy blanks = BlankPolicy::kErrors;
  std::string segment_column;
  std::map<std::string, std::vector<std::string>> only;  ///< By text column.
  double bandwidth_hz = 0.0;                             ///< 0: chosen.
  std::vector<std::string> filtered_with;
  HeldOut held_out;
  std::vector<PublishedFigure> published;
  std::optional<StrictTable> root;  ///< To say where something stands; none: there is no such file.
};

/// Reads the file; `signals` are the names that the plant has.
/// @throws ConfigError with file, line and key.
[[nodiscard]] RecordingFile ReadRecordingFile(const std::filesystem::path& path,
                                              const std::vector<std::string>& signals);

}  // namespace armcmc::support
