#include "armcmc/support/text_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "armcmc/support/printable.hpp"

namespace armcmc::support {
namespace {

constexpr std::size_t kLongestCell = 200;  // characters

}  // namespace

TextTable::TextTable(std::vector<std::string> header, Content content) : content_(content) {
  rows_.push_back(std::move(header));
}

void TextTable::AddRow(std::vector<std::string> cells) {
  if (cells.size() > rows_.front().size()) throw std::invalid_argument("more cells than the table has columns");
  for (std::string& cell : cells) cell = Printable(cell, kLongestCell);
  cells.resize(rows_.front().size());
  rows_.push_back(std::move(cells));
}

std::string TextTable::ToString() const {
  std::vector<std::size_t> width(rows_.front().size(), 0);
  for (const auto& row : rows_)
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
  std::string text;
  for (std::size_t n = 0; n < rows_.size(); ++n) {
    std::string line;
    for (std::size_t i = 0; i < width.size(); ++i) {
      const std::string pad(width[i] - rows_[n][i].size(), ' ');
      if (i > 0) line += "  ";
      line += i == 0 || content_ == Content::kWords ? rows_[n][i] + pad : pad + rows_[n][i];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
    if (n != 0) continue;
    std::size_t rule = 0;
    for (std::size_t w : width) rule += w + 2;
    text += std::string(rule - 2, '-') + "\n";
  }
  return text;
}

std::string Significant(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  return text.data();
}

}  // namespace armcmc::support
