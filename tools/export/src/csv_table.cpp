#include "csv_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "armcmc/log_export/columns.hpp"
#include "armcmc/support/program.hpp"
#include "number_text.hpp"
#include "rows.hpp"

namespace armcmc::log_export {
namespace {

using Bytes = std::span<const std::uint8_t>;

void AppendText(const std::string& text, std::string* row) {
  const bool quoted = text.find_first_of(",\"") != std::string::npos;
  if (quoted) row->push_back('"');
  for (const char c : text) row->append(c == '"' ? 2 : 1, c);
  if (quoted) row->push_back('"');
}

/// Quoted where a name holds a space: PlotJuggler takes what stands more often outside quotes, commas or spaces, for
/// the separator.
void AppendHeader(const std::string& name, std::string* row) {
  if (name.find(' ') == std::string::npos) return AppendText(name, row);
  row->push_back('"');
  for (const char c : name) row->append(c == '"' ? 2 : 1, c);
  row->push_back('"');
}

/// The first number of a column, by which PlotJuggler decides whether the column holds numbers: some versions of it
/// take an exponent for text, and all take ten digits without a point for a time since 1970.
void AppendFirstNumber(double value, std::string* row) {
  std::array<char, 400> text{};  // the smallest double has 324 decimals
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed).ptr;
  const std::string_view digits(text.data(), static_cast<std::size_t>(end - text.data()));
  row->append(digits);
  if (digits.size() >= 10 && digits.find('.') == std::string_view::npos) row->append(".0");
}

/// The table of one channel while it is written.
class Table final : public Sink {
 public:
  Table(const ChannelScan& channel, const PlantScan& plant, std::filesystem::path path, bool long_histograms)
      : plant_(plant),
        columns_(ColumnsOf(channel, plant)),
        rows_of_(channel, plant, columns_),
        path_(std::move(path)),
        file_(path_, std::ios::binary) {
    if (!file_) throw support::InputError(path_.string() + ": cannot be written");
    long_ = long_histograms && channel.type->Find("density") != nullptr;
    AppendHeader("t [s]", &row_);
    if (long_) {
      row_ += ",seq,mode,parameter,unit,bin,from,to,density";
    } else {
      for (const Column& column : columns_) row_.push_back(','), AppendHeader(column.header, &row_);
    }
    EndRow();
    rows_ = 0;
    has_number_.resize(columns_.size() + 1, false);
  }

  void Write(Bytes data, const MessageType& type, const EventTime& time) override {
    if (long_) return WriteHistograms(data, type, time.t);
    rows_of_.ForEach(data, type, time.t, [&](double t, std::size_t sample) { WriteRow(data, t, sample); });
  }

  std::int64_t Close() override {
    if (!file_.flush()) throw std::runtime_error(path_.string() + ": writing failed");
    return rows_;
  }

 private:
  void WriteRow(Bytes data, double t, std::size_t sample) {
    AppendReal(t, columns_.size());
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const Column& column = columns_[i];
      row_.push_back(',');
      const std::size_t index = column.index + sample * column.sample_stride;
      if (column.text) {
        AppendText(TextAt(data, *column.field, index), &row_);
      } else if (IsReal(*column.field)) {
        AppendReal(NumberAt(data, *column.field, index), i);
      } else {
        AppendNumber(IntegerAt(data, *column.field, index), &row_);
      }
    }
    EndRow();
  }

  /// Empty where it is not finite: a viewer leaves the point out, pandas reads NaN. "inf" or "nan" as the first cell
  /// makes PlotJuggler take the whole column for text.
  void AppendReal(double value, std::size_t column) {
    if (!std::isfinite(value)) return;
    if (!has_number_[column]) {
      has_number_[column] = true;
      return AppendFirstNumber(value, &row_);
    }
    AppendNumber(value, &row_);
  }

  void WriteHistograms(Bytes data, const MessageType& type, double t) {
    const auto integer = [&](const char* name) { return IntegerAt(data, *type.Find(name), 0); };
    const MessageField& density = *type.Find("density");
    const std::int64_t parameters = std::clamp<std::int64_t>(integer("n_params"), 0, density.dims[0]);
    const std::int64_t bins = std::clamp<std::int64_t>(integer("n_bins"), 0, density.dims[1]);
    if (integer("known") == 0) return;
    for (std::int64_t p = 0; p < parameters; ++p) {
      const auto i = static_cast<std::size_t>(p);
      const double lo = NumberAt(data, *type.Find("lo"), i), hi = NumberAt(data, *type.Find("hi"), i);
      const double width = (hi - lo) / static_cast<double>(bins);
      for (std::int64_t bin = 0; bin < bins; ++bin) {
        AppendNumber(t, &row_);
        for (const std::int64_t value : {integer("seq"), integer("mode")})
          row_.push_back(','), AppendNumber(value, &row_);
        row_.append(",").append(ParameterName(plant_, i)).append(",");
        AppendText(ParameterUnit(plant_, i), &row_);
        row_.push_back(',');
        AppendNumber(bin, &row_);
        const auto at = i * static_cast<std::size_t>(density.dims[1]) + static_cast<std::size_t>(bin);
        for (const double value : {lo + static_cast<double>(bin) * width, lo + static_cast<double>(bin + 1) * width,
                                   NumberAt(data, density, at)})
          row_.push_back(','), AppendNumber(value, &row_);
        EndRow();
      }
    }
  }

  void EndRow() {
    row_.push_back('\n');
    file_ << row_;
    row_.clear();
    ++rows_;
  }

  const PlantScan& plant_;
  std::vector<Column> columns_;
  std::vector<bool> has_number_;  // by column, the time last: a row before has one
  Rows rows_of_;
  std::filesystem::path path_;
  std::ofstream file_;
  std::string row_;
  bool long_ = false;
  std::int64_t rows_ = 0;
};

}  // namespace

std::unique_ptr<Sink> NewCsvTable(const ChannelScan& channel, const PlantScan& plant, const std::filesystem::path& path,
                                  bool long_histograms) {
  return std::make_unique<Table>(channel, plant, path, long_histograms);
}

}  // namespace armcmc::log_export
