#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace armcmc::support {

/// A column that may be missing when another one is there to differentiate by t.
struct DerivedColumn {
  std::string name;  ///< "v"
  std::string from;  ///< "x"
};

/// What to read from a CSV file of samples, and how strictly.
struct CsvRequest {
  std::vector<std::string> columns;    ///< Wanted columns, in the order of the result. The first is the time.
  std::vector<DerivedColumn> derived;  ///< Which of them may be derived.
  bool skip_bad = false;               ///< Count and skip bad rows; otherwise the first one is an error.
  /// Nothing is looked at from the first row on whose time is beyond it: for files of several runs.
  double until = std::numeric_limits<double>::infinity();
};

/// Bad rows by cause. All zero unless skip_bad was asked for.
struct BadRows {
  std::size_t malformed = 0;       ///< Wrong number of fields, not a number, or cut off.
  std::size_t non_finite = 0;      ///< NaN, infinite or empty.
  std::size_t not_increasing = 0;  ///< t not above that of the last row kept.
  [[nodiscard]] std::size_t total() const { return malformed + non_finite + not_increasing; }
};

/// Samples by column.
struct CsvSamples {
  std::vector<std::vector<double>> columns;  ///< [wanted column][row]
  BadRows bad;
  std::vector<std::string> notes;  ///< For the user: columns derived, rows skipped.
  [[nodiscard]] std::size_t num_rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

/// Reads samples from a CSV file: one header line of names; fields separated by commas, semicolons or tabs, as the
/// header is; `#` comment lines, blank lines, quotes, Windows line ends and a byte order mark allowed.
///
/// Where the first wanted column is `t` and the file has none, `t [s]`, `__time` or `time` is the time, with a note.
/// Times since 1970, from 1e8 s on, count from the first one, with a note: their differences are exact.
///
/// Numbers are read to the nearest double, whatever the locale. Other columns are ignored. The last line must
/// end with a line end: a cut number looks like a number. A missing derived column becomes the rate
/// of the one that it is derived from: filtered without delay, with the bandwidth that its noise suggests, if the rows
/// are evenly spaced between gaps, else by central differences. Memory: 8 bytes a wanted value.
/// @throws InputError naming file, line and what was expected.
[[nodiscard]] CsvSamples ReadCsv(const std::filesystem::path& path, const CsvRequest& request);

/// Shortest text that reads back as the same double.
[[nodiscard]] std::string ExactNumber(double value);

}  // namespace armcmc::support
