#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace armcmc::support {

/// Columns of a CSV file as they stand there, whatever their order and meaning.
struct CsvColumns {
  std::vector<std::string> header;
  std::map<std::string, std::vector<double>> number;     ///< Of the columns that were asked for as numbers.
  std::map<std::string, std::vector<std::string>> text;  ///< Of those that were asked for as text.
  std::vector<std::size_t> line;                         ///< [row] Where it stands in the file.
  std::map<std::size_t, std::string> bad;                ///< [row] What is wrong with a bad row that was kept.
  std::size_t skipped = 0;                               ///< Bad rows that were not.
  double start = 0.0;                                    ///< What the times count from, in the unit of their column.
  [[nodiscard]] std::size_t num_rows() const { return line.size(); }
};

/// Names in the header of a CSV file. @throws InputError.
[[nodiscard]] std::vector<std::string> ReadCsvHeader(const std::filesystem::path& path);

/// What becomes of bad rows: a cell of a number column that is no finite number, too few or too many fields, a last
/// line without an end.
enum class BadRowPolicy : std::uint8_t {
  kErrors,
  kSkipped,  ///< And counted.
  kKept,     ///< Whoever selects rows may do without them; what cannot be read is not a number, or an empty text.
};

/// The column of time, if one is read.
struct TimeColumn {
  std::string name;  ///< Empty: none.
  double far = 0.0;  ///< Times from this size on count from the first one, in the unit of the column.
};

/// Reads the columns.
/// @param blanks_are_bad  A cell without text is no finite number; otherwise it is not a number in a good row, but for
/// the
///                        time, which no row may lack.
/// @throws InputError naming file, line and column.
[[nodiscard]] CsvColumns ReadCsvColumns(const std::filesystem::path& path, const std::vector<std::string>& numbers,
                                        const std::vector<std::string>& texts, BadRowPolicy bad_rows,
                                        const TimeColumn& time = {}, bool blanks_are_bad = true);

}  // namespace armcmc::support
