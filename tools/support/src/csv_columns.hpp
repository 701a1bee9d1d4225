#pragma once

#include <cstddef>
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
  std::size_t skipped = 0;                               ///< Bad rows.
  [[nodiscard]] std::size_t num_rows() const { return line.size(); }
};

/// Names in the header of a CSV file. @throws InputError.
[[nodiscard]] std::vector<std::string> ReadCsvHeader(const std::filesystem::path& path);

/// Reads the columns. A cell of a number column that is no finite number, a row with too few or too many fields and a
/// last line without an end are errors, or are skipped and counted.
/// @throws InputError naming file, line and column.
[[nodiscard]] CsvColumns ReadCsvColumns(const std::filesystem::path& path, const std::vector<std::string>& numbers,
                                        const std::vector<std::string>& texts, bool skip_bad);

}  // namespace armcmc::support
