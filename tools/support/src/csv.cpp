#include "armcmc/support/csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "armcmc/support/program.hpp"
#include "armcmc/support/text_table.hpp"
#include "csv_text.hpp"
#include "nearest.hpp"
#include "rate_of.hpp"

namespace armcmc::support {
namespace {

constexpr std::size_t kAbsent = std::numeric_limits<std::size_t>::max();

class Reader {
 public:
  Reader(const std::filesystem::path& path, const CsvRequest& request) : path_(path), request_(request), lines_(path) {
    if (!lines_.is_open() || std::filesystem::is_directory(path))
      throw InputError(path.string() + ": cannot be read, expected a CSV file");
  }

  CsvSamples Read() {
    ReadHeader();
    result_.columns.resize(request_.columns.size());
    std::string line;
    while (!ended_ && lines_.Next(&line)) {
      if (IsBlankOrComment(line)) continue;
      ReadRow(line);
    }
    if (result_.num_rows() == 0) throw InputError(path_.string() + ": holds no valid row of numbers");
    if (result_.bad.total() > result_.num_rows())
      throw InputError(path_.string() + ": " + std::to_string(result_.bad.total()) + " rows are bad and only " +
                       std::to_string(result_.num_rows()) + " good, too few to continue");
    NoteBadRows();
    if (time_.start() != 0.0)
      result_.notes.push_back("times count from the first one, " + ExactNumber(time_.start()) + " s");
    DeriveAll();
    return std::move(result_);
  }

 private:
  [[nodiscard]] InputError Error(const std::string& what) const {
    return InputError(path_.string() + ":" + std::to_string(lines_.number()) + ": " + what);
  }

  void ReadHeader() {
    std::string line;
    do {
      if (!lines_.Next(&line))
        throw InputError(path_.string() + ": is empty, expected a header line " + JoinedNames(request_.columns));
    } while (IsBlankOrComment(line));
    separator_ = SeparatorOf(line);
    const std::vector<std::string> header = HeaderNames(line);
    num_fields_ = header.size();
    for (const std::string& name : request_.columns) source_.push_back(Find(header, name));
    if (request_.columns.front() == "t" && header[source_.front()] != "t")
      result_.notes.push_back("column t is missing: the time is " + Printable(header[source_.front()]));
  }

  [[nodiscard]] std::size_t Find(const std::vector<std::string>& header, const std::string& name) const {
    auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end() && name == "t" && FindTime(header) != std::string::npos)
      found = header.begin() + static_cast<std::ptrdiff_t>(FindTime(header));
    if (found == header.end()) {
      const auto derived = std::find_if(request_.derived.begin(), request_.derived.end(),
                                        [&](const DerivedColumn& d) { return d.name == name; });
      if (derived != request_.derived.end()) return kAbsent;
      throw Error("column " + name + " is missing" + DidYouMean(name, header) + "; the header has " +
                  JoinedNames(header) + ", expected " + JoinedNames(request_.columns) + HeaderHint(header));
    }
    if (std::find(found + 1, header.end(), *found) != header.end())
      throw Error("column " + Printable(*found) + " appears twice in the header");
    return static_cast<std::size_t>(found - header.begin());
  }

  /// Counts a bad row, or throws when bad rows are not to be skipped.
  void Reject(std::size_t BadRows::*cause, const std::string& what) {
    if (!request_.skip_bad) throw Error(what + " (--skip-bad counts and skips bad rows)");
    ++(result_.bad.*cause);
  }

  void ReadRow(const std::string& line) {
    SplitFields(line, separator_, &fields_);
    if (!lines_.complete())
      return Reject(&BadRows::malformed, "the last line has no line end: the file is cut off here");
    if (fields_.size() != num_fields_)
      return Reject(&BadRows::malformed, "has " + std::to_string(fields_.size()) + " fields, expected " +
                                             std::to_string(num_fields_) + " as in the header");
    row_.clear();
    for (std::size_t i = 0; i < source_.size(); ++i) {
      if (source_[i] == kAbsent) continue;
      const std::string_view text = fields_[source_[i]];
      const auto what = [&] { return request_.columns[i] + " = " + (text.empty() ? "(empty)" : Printable(text)); };
      const bool is_time = i == 0 && request_.columns[i] == "t";
      const std::optional<double> value = text.empty() ? std::numeric_limits<double>::quiet_NaN()
                                          : is_time    ? time_.Parse(text)
                                                       : ParseNumber(text);
      if (!value) return Reject(&BadRows::malformed, what() + ": expected a number" + NumberHint(text));
      if (!std::isfinite(*value))
        return Reject(&BadRows::non_finite,
                      what() + ": expected a finite number" + (text.empty() ? NumberHint(text) : ""));
      row_.push_back(*value);
    }
    std::vector<double>& t = result_.columns.front();
    ended_ = time_.start() + row_.front() > request_.until;
    if (ended_) return;
    if (!t.empty() && row_.front() <= t.back())
      return Reject(&BadRows::not_increasing, request_.columns.front() + " = " + ExactNumber(row_.front()) +
                                                  ": expected more than " + ExactNumber(t.back()) +
                                                  " of the row before, time must increase");
    for (std::size_t i = 0, next = 0; i < source_.size(); ++i)
      if (source_[i] != kAbsent) result_.columns[i].push_back(row_[next++]);
  }

  void NoteBadRows() {
    const BadRows& bad = result_.bad;
    if (bad.total() == 0) return;
    result_.notes.push_back("skipped " + std::to_string(bad.total()) + " bad rows: " + std::to_string(bad.malformed) +
                            " malformed, " + std::to_string(bad.non_finite) + " not finite, " +
                            std::to_string(bad.not_increasing) + " with a time that does not increase");
  }

  void DeriveAll() {
    // One may be derived from another that is derived itself: as many rounds as there are at most.
    for (std::size_t round = 0; round < request_.derived.size(); ++round) DeriveFromKnown();
  }

  void DeriveFromKnown() {
    const std::vector<double>& t = result_.columns.front();
    for (std::size_t i = 0; i < source_.size(); ++i) {
      if (source_[i] != kAbsent || !result_.columns[i].empty()) continue;
      const auto rule = std::find_if(request_.derived.begin(), request_.derived.end(),
                                     [&](const DerivedColumn& d) { return d.name == request_.columns[i]; });
      const auto from = std::find(request_.columns.begin(), request_.columns.end(), rule->from);
      const std::vector<double>& x = result_.columns[static_cast<std::size_t>(from - request_.columns.begin())];
      if (x.empty()) continue;
      if (t.size() < 2) throw InputError(path_.string() + ": one row is too few to derive " + rule->name);
      Rate rate = RateOf(t, x);
      result_.columns[i] = std::move(rate.value);
      result_.notes.push_back("column " + rule->name + " is missing: derived from " + rule->from +
                              (rate.bandwidth_hz > 0.0
                                   ? ", " + Significant(rate.bandwidth_hz, 3) + " Hz, chosen by the noise"
                                   : " by central differences"));
    }
  }

  const std::filesystem::path& path_;
  const CsvRequest& request_;
  LineReader lines_;
  char separator_ = ',';
  TimeCells time_{kFarTime};
  std::size_t num_fields_ = 0;
  std::vector<std::size_t> source_;  // field of each wanted column, or kAbsent
  std::vector<std::string_view> fields_;
  std::vector<double> row_;
  CsvSamples result_;
  bool ended_ = false;  ///< A row was beyond the time that is asked for.
};

}  // namespace

CsvSamples ReadCsv(const std::filesystem::path& path, const CsvRequest& request) {
  return Reader(path, request).Read();
}

std::string ExactNumber(double value) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), result.ptr};
}

}  // namespace armcmc::support
