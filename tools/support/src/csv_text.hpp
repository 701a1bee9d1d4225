#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
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

/// What separates the fields of a file whose first line that line is: the comma, the semicolon or the tab that stands
/// in it most often outside of quotes; a comma where there is none.
inline char SeparatorOf(std::string_view header) {
  constexpr std::string_view kSeparators = ",;\t";
  std::array<std::size_t, kSeparators.size()> count{};
  bool quoted = false;
  for (const char c : header) {
    if (c == '"') quoted = !quoted;
    if (const std::size_t which = kSeparators.find(c); !quoted && which != std::string_view::npos) ++count[which];
  }
  return kSeparators[static_cast<std::size_t>(std::max_element(count.begin(), count.end()) - count.begin())];
}

/// The fields of a line, without the quotes around them; between quotes a separator belongs to the field.
inline void SplitFields(std::string_view line, char separator, std::vector<std::string_view>* fields) {
  fields->clear();
  for (std::size_t from = 0;;) {
    std::size_t start = from;
    while (start < line.size() && line[start] != separator && (line[start] == ' ' || line[start] == '\t')) ++start;
    const bool quoted = start < line.size() && line[start] == '"';
    const std::size_t closing = quoted ? line.find('"', start + 1) : std::string_view::npos;
    const std::size_t end = line.find(separator, closing == std::string_view::npos ? from : closing);
    std::string_view field = TrimField(line.substr(from, end == std::string_view::npos ? end : end - from));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    fields->push_back(field);
    if (end == std::string_view::npos) return;
    from = end + 1;
  }
}

/// The names of a header line.
inline std::vector<std::string> HeaderNames(std::string_view line) {
  std::vector<std::string_view> fields;
  SplitFields(line, SeparatorOf(line), &fields);
  return {fields.begin(), fields.end()};
}

/// The column that is the time where nobody says which one: "t", or what other programs call a time in seconds; npos
/// where there is none.
inline std::size_t FindTime(const std::vector<std::string>& header) {
  for (const char* name : {"t", "t [s]", "__time", "time"}) {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found != header.end()) return static_cast<std::size_t>(found - header.begin());
  }
  return std::string::npos;
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

/// What to do about a text that is no number, where that can be told; else nothing.
inline std::string NumberHint(std::string_view text) {
  if (text.empty())
    return "; a recording file with [rows] blanks = \"skip\" or \"interpolate\" reads tables with blank cells";
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || text.find(',', comma + 1) != std::string_view::npos) return "";
  std::string pointed(text);
  pointed[comma] = '.';
  return ParseNumber(pointed) ? " with a point as decimal separator" : "";
}

/// Times of a column. A time since 1970 has more digits before the point than leave room for a sample interval behind
/// it: where the first one is that large, times count from it, and their differences are those of the decimals as
/// written.
class TimeCells {
 public:
  /// @param far  From which size on times count from the first one.
  explicit TimeCells(double far) : far_(far) {}

  /// none where the text is no number.
  std::optional<double> Parse(std::string_view text) {
    const std::optional<double> value = ParseNumber(text);
    if (!value || !std::isfinite(*value)) return value;
    if (!decided_) {
      decided_ = true;
      counts_from_first_ = std::fabs(*value) >= far_;
      if (counts_from_first_) first_ = Split(text, *value), start_ = *value;
    }
    if (!counts_from_first_) return value;
    const Parts parts = Split(text, *value);
    return static_cast<double>(parts.whole - first_.whole) + (parts.rest - first_.rest);
  }
  /// What the times count from, as far as a double has it.
  [[nodiscard]] double start() const { return start_; }

 private:
  struct Parts {
    std::int64_t whole = 0;
    double rest = 0.0;
  };
  static Parts Split(std::string_view text, double value) {
    constexpr double kMost = 4e18;  // whose differences are integers, too
    if (!(std::fabs(value) < kMost)) return {0, value};
    Parts parts;
    const auto [end, error] =
        std::from_chars(text.data() + (text.starts_with('+') ? 1 : 0), text.data() + text.size(), parts.whole);
    const std::string_view rest = text.substr(static_cast<std::size_t>(end - text.data()));
    if (error == std::errc() && rest.find_first_of("eE") == std::string_view::npos) {
      if (!rest.empty()) parts.rest = std::copysign(ParseNumber("0" + std::string(rest)).value_or(0.0), value);
      return parts;
    }
    parts.whole = static_cast<std::int64_t>(value);
    parts.rest = value - static_cast<double>(parts.whole);
    return parts;
  }

  double far_;
  bool decided_ = false, counts_from_first_ = false;
  Parts first_;
  double start_ = 0.0;
};

/// s, from which on a time is one since 1970: three years.
inline constexpr double kFarTime = 1e8;

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
  if (first.find(' ') == std::string::npos) return "";
  return "; its fields are separated by spaces, expected commas, semicolons or tabs, and a point as decimal separator";
}

}  // namespace armcmc::support
