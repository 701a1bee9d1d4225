#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace armcmc::support {

/// A small table in plain text.
class TextTable {
 public:
  /// What the columns behind the first hold: numbers stand right-aligned, words left-aligned. The first holds names.
  enum class Content : std::uint8_t { kNumbers, kWords };

  explicit TextTable(std::vector<std::string> header, Content content = Content::kNumbers);
  /// A short row is filled with empty cells. @throws std::invalid_argument for more cells than the header has.
  void AddRow(std::vector<std::string> cells);
  /// Every line ends with a line end; two spaces between columns, a rule under the header.
  [[nodiscard]] std::string ToString() const;

 private:
  std::vector<std::vector<std::string>> rows_;  // the header first
  Content content_;
};

/// A number for people: so many significant digits, "-" when it is not finite.
[[nodiscard]] std::string Significant(double value, int digits);

}  // namespace armcmc::support
