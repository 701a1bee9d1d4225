#pragma once

#include <string>
#include <vector>

namespace armcmc::support {

/// A small table in plain text: the first column left-aligned, the others right-aligned.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header);
  /// A short row is filled with empty cells. @throws std::invalid_argument for more cells than the header has.
  void AddRow(std::vector<std::string> cells);
  /// Every line ends with a line end; two spaces between columns, a rule under the header.
  [[nodiscard]] std::string ToString() const;

 private:
  std::vector<std::vector<std::string>> rows_;  // the header first
};

/// A number for people: so many significant digits, "-" when it is not finite.
[[nodiscard]] std::string Significant(double value, int digits);

}  // namespace armcmc::support
