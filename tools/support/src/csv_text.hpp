#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "armcmc/support/printable.hpp"

namespace armcmc::support {

// The characters of CSV files: lines, fields, numbers.

inline std::string_view TrimField(std::string_view text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// The fields of a line, without the quotes around them; between quotes a comma belongs to the field.
inline void SplitFields(std::string_view line, std::vector<std::string_view>* fields) {
  fields->clear();
  for (std::size_t from = 0;;) {
    const std::size_t start = std::min(line.find_first_not_of(" \t", from), line.size());
    const bool quoted = start < line.size() && line[start] == '"';
    const std::size_t closing = quoted ? line.find('"', start + 1) : std::string_view::npos;
    const std::size_t comma = line.find(',', closing == std::string_view::npos ? from : closing);
    std::string_view field = TrimField(line.substr(from, comma == std::string_view::npos ? comma : comma - from));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    fields->push_back(field);
    if (comma == std::string_view::npos) return;
    from = comma + 1;
  }
}

/// The names of a header line.
inline std::vector<std::string> HeaderNames(std::string_view line) {
  std::vector<std::string_view> fields;
  SplitFields(line, &fields);
  return {fields.begin(), fields.end()};
}

/// The nearest double, whatever the locale; none where the text is no number.
inline std::optional<double> ParseNumber(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  // Beyond the range of a double the nearest value is zero or infinite; from_chars leaves that to the caller.
  if (error == std::errc::result_out_of_range) return std::strtod(std::string(text).c_str(), nullptr);
  if (error != std::errc()) return std::nullopt;
  return value;
}

inline bool IsBlankOrComment(std::string_view line) {
  const std::string_view text = TrimField(line);
  return text.empty() || text.front() == '#';
}

/// Reads lines and remembers whether the last one had a line end.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& path) : file_(path, std::ios::binary) {}
  [[nodiscard]] bool is_open() const { return file_.is_open(); }
  bool Next(std::string* line) {
    if (!std::getline(file_, *line)) return false;
    complete_ = !file_.eof();
    ++number_;
    if (number_ == 1 && line->starts_with("\xEF\xBB\xBF")) line->erase(0, 3);  // byte order mark
    return true;
  }
  /// The next line that is neither blank nor a comment.
  bool NextRow(std::string* line) {
    while (Next(line))
      if (!IsBlankOrComment(*line)) return true;
    return false;
  }
  [[nodiscard]] std::size_t number() const { return number_; }
  [[nodiscard]] bool complete() const { return complete_; }

 private:
  std::ifstream file_;
  std::size_t number_ = 0;
  bool complete_ = true;
};

/// As a message may list them: of a header that has very many names the first.
inline std::string JoinedNames(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 24;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) text += (i == 0 ? "" : ",") + Printable(names[i]);
  return names.size() > kMost ? text + ",... (" + std::to_string(names.size()) + " in all)" : text;
}

/// Why a header holds none of the names that were expected, where its characters tell; else nothing.
inline std::string HeaderHint(const std::vector<std::string>& header) {
  const std::string& first = header.front();
  if (first.find('\0') != std::string::npos) return "; it is no UTF-8 text: UTF-16, or no CSV at all?";
  if (header.size() > 1) return "";
  for (const auto& [separator, name] : {std::pair{';', "semicolons"}, {'\t', "tabs"}, {' ', "spaces"}})
    if (first.find(separator) != std::string::npos)
      return std::string("; its fields are separated by ") + name +
             ", expected commas, and a point as decimal separator";
  return "";
}

}  // namespace armcmc::support
