#include "csv_columns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "armcmc/support/program.hpp"
#include "csv_text.hpp"
#include "nearest.hpp"

namespace armcmc::support {
namespace {

LineReader Open(const std::filesystem::path& path, std::string* header) {
  LineReader lines(path);
  if (!lines.is_open() || std::filesystem::is_directory(path))
    throw InputError(path.string() + ": cannot be read, expected a CSV file");
  if (!lines.NextRow(header)) throw InputError(path.string() + ": is empty, expected a header line");
  return lines;
}

std::size_t FieldOf(const std::filesystem::path& path, const std::vector<std::string>& header,
                    const std::string& name) {
  const auto found = std::find(header.begin(), header.end(), name);
  if (found == header.end())
    throw InputError(path.string() + ": column " + name + " is missing" + DidYouMean(name, header) +
                     "; the header has " + JoinedNames(header) + HeaderHint(header));
  if (std::find(found + 1, header.end(), name) != header.end())
    throw InputError(path.string() + ": column " + name + " appears twice in the header");
  return static_cast<std::size_t>(found - header.begin());
}

}  // namespace

std::vector<std::string> ReadCsvHeader(const std::filesystem::path& path) {
  std::string line;
  (void)Open(path, &line);
  return HeaderNames(line);
}

CsvColumns ReadCsvColumns(const std::filesystem::path& path, const std::vector<std::string>& numbers,
                          const std::vector<std::string>& texts, BadRowPolicy bad_rows, const TimeColumn& time,
                          bool blanks_are_bad) {
  CsvColumns columns;
  std::string line;
  LineReader lines = Open(path, &line);
  columns.header = HeaderNames(line);
  const char separator = SeparatorOf(line);
  TimeCells times(time.far);
  std::vector<std::pair<std::size_t, std::vector<double>*>> number_fields;
  std::vector<std::pair<std::size_t, std::vector<std::string>*>> text_fields;
  number_fields.reserve(numbers.size());
  text_fields.reserve(texts.size());
  for (const std::string& name : numbers)
    number_fields.emplace_back(FieldOf(path, columns.header, name), &columns.number[name]);
  for (const std::string& name : texts)
    text_fields.emplace_back(FieldOf(path, columns.header, name), &columns.text[name]);

  std::vector<std::string_view> fields;
  std::vector<double> row(number_fields.size());
  while (lines.NextRow(&line)) {
    SplitFields(line, separator, &fields);
    std::string problem;
    std::fill(row.begin(), row.end(), std::numeric_limits<double>::quiet_NaN());
    if (!lines.complete()) {
      problem = "the last line has no line end: the file is cut off here";
    } else if (fields.size() != columns.header.size()) {
      problem = "has " + std::to_string(fields.size()) + " fields, expected " + std::to_string(columns.header.size()) +
                " as in the header";
    }
    for (std::size_t i = 0; i < number_fields.size() && fields.size() == columns.header.size(); ++i) {
      const std::string_view text = fields[number_fields[i].first];
      const bool is_time = numbers[i] == time.name;
      row[i] = (is_time ? times.Parse(text) : ParseNumber(text)).value_or(std::numeric_limits<double>::quiet_NaN());
      if (text.empty() && !blanks_are_bad && !is_time) continue;
      if (!std::isfinite(row[i]) && problem.empty())
        problem = Printable(columns.header[number_fields[i].first]) + " = " +
                  (text.empty() ? "(empty)" : Printable(text)) + ": expected a finite number" + NumberHint(text);
    }
    if (!problem.empty() && bad_rows != BadRowPolicy::kKept) {
      if (bad_rows == BadRowPolicy::kErrors)
        throw InputError(path.string() + ":" + std::to_string(lines.number()) + ": " + problem +
                         " (--skip-bad counts and skips bad rows)");
      ++columns.skipped;
      continue;
    }
    if (!problem.empty()) columns.bad.emplace(columns.num_rows(), std::move(problem));
    for (std::size_t i = 0; i < number_fields.size(); ++i) number_fields[i].second->push_back(row[i]);
    for (const auto& [field, text] : text_fields)
      text->emplace_back(field < fields.size() ? fields[field] : std::string_view());
    columns.line.push_back(lines.number());
  }
  columns.start = times.start();
  if (columns.line.size() == columns.bad.size() && !columns.bad.empty())
    throw InputError(path.string() + ":" + std::to_string(columns.line.front()) + ": " + columns.bad.begin()->second);
  if (columns.line.empty()) throw InputError(path.string() + ": holds no valid row of numbers");
  if (columns.skipped > columns.line.size())
    throw InputError(path.string() + ": " + std::to_string(columns.skipped) + " rows are bad and only " +
                     std::to_string(columns.line.size()) + " good, too few to continue");
  return columns;
}

}  // namespace armcmc::support
