#include "recording_rows.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "armcmc/expression/check.hpp"
#include "armcmc/expression/features.hpp"
#include "armcmc/expression/graph.hpp"
#include "armcmc/support/csv.hpp"
#include "armcmc/support/program.hpp"
#include "csv_columns.hpp"
#include "nearest.hpp"

namespace armcmc::support {
namespace {

/// What a source says, with the columns that it reads.
class Source {
 public:
  Source(const std::string& name, const std::string& key, const ColumnSource& source,
         const std::vector<std::string>& header)
      : source_(source) {
    if (source.value.empty()) {
      columns_ = {source.column};
      return;
    }
    try {
      Compile(header);
    } catch (const expression::Error& error) {
      throw ConfigError(name + ": columns." + key + ".value: character " + std::to_string(error.column()) + ": " +
                        error.what());
    }
  }

  [[nodiscard]] const std::vector<std::string>& columns() const noexcept { return columns_; }

  [[nodiscard]] std::vector<double> Values(const CsvColumns& csv) const {
    std::vector<double> values(csv.num_rows());
    std::vector<double> row(columns_.size());
    for (std::size_t n = 0; n < values.size(); ++n) {
      for (std::size_t c = 0; c < columns_.size(); ++c) row[c] = csv.number.at(columns_[c])[n];
      if (source_.value.empty()) {
        values[n] = source_.scale * row[0] + source_.offset;
      } else {
        program_.Evaluate({row.data(), 0.0, 0.0}, nullptr, &values[n]);
      }
    }
    return values;
  }

 private:
  void Compile(const std::vector<std::string>& header) {
    const expression::Syntax syntax = expression::Parse(source_.value);
    expression::Scope scope;
    std::set<std::string> named;
    for (const expression::SyntaxNode& node : syntax.nodes)
      if (node.op == expression::Op::kSymbol) named.insert(node.name);
    for (const std::string& column : header) {
      if (!expression::IsFreeName(column) || scope.Find(column) != nullptr) continue;
      expression::Symbol symbol;
      symbol.name = column;
      symbol.kind = expression::SymbolKind::kSignal;
      symbol.index = static_cast<int>(columns_.size());
      if (named.count(column) > 0) columns_.push_back(column);
      scope.Add(std::move(symbol));
    }
    const expression::Meaning meaning = Check(syntax, scope);
    if (meaning.memory) throw expression::Error(1, "a column is made row by row: no function with memory");
    expression::Graph graph;
    const int node = graph.Lower(syntax, scope, {});
    program_ = expression::FeatureProgram(graph, {node});
  }

  ColumnSource source_;
  std::vector<std::string> columns_;
  expression::FeatureProgram program_;
};

bool Contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool Within(const std::vector<RowRange>& ranges, std::size_t row) {
  return std::any_of(ranges.begin(), ranges.end(), [row](const RowRange& r) { return row >= r.from && row < r.until; });
}

/// Which rows a recording uses, and which it keeps apart.
class Selection {
 public:
  Selection(const RecordingFile& file, const CsvColumns& csv) : file_(file), csv_(csv) {}

  [[nodiscard]] bool Uses(std::size_t row, double t) const {
    if (file_.rows && !Within({*file_.rows}, row)) return false;
    if ((file_.from_s && t < *file_.from_s) || (file_.until_s && t >= *file_.until_s)) return false;
    if (Within(file_.drop, row) || row % file_.every != (file_.rows ? file_.rows->from % file_.every : 0)) return false;
    return std::all_of(file_.only.begin(), file_.only.end(),
                       [&](const auto& only) { return Contains(only.second, csv_.text.at(only.first)[row]); });
  }
  [[nodiscard]] bool HoldsOut(std::size_t row, double t) const {
    const HeldOut& held = file_.held_out;
    return Within(held.rows, row) || (held.from_s && t >= *held.from_s) ||
           (!held.segments.empty() && Contains(held.segments, Segment(row)));
  }
  [[nodiscard]] std::string Segment(std::size_t row) const {
    return file_.segment_column.empty() ? std::string() : csv_.text.at(file_.segment_column)[row];
  }

 private:
  const RecordingFile& file_;
  const CsvColumns& csv_;
};

}  // namespace

void RecordingRows::Append(const RecordingRows& other) {
  const std::size_t first = size();
  t.insert(t.end(), other.t.begin(), other.t.end());
  for (std::size_t s = 0; s < signal.size(); ++s)
    signal[s].insert(signal[s].end(), other.signal[s].begin(), other.signal[s].end());
  new_run.insert(new_run.end(), other.new_run.begin(), other.new_run.end());
  held_out.insert(held_out.end(), other.held_out.begin(), other.held_out.end());
  if (first < size()) new_run[first] = 1;
  skipped += other.skipped;
}

RecordingRows ReadRecordingRows(const std::filesystem::path& csv_path, const RecordingFile& file,
                                const std::map<std::string, ColumnSource>& sources, const PlantDescription& plant,
                                const std::string& name, bool skip_bad) {
  const std::vector<std::string> header = ReadCsvHeader(csv_path);
  const auto source_of = [&](const std::string& signal) -> std::optional<Source> {
    if (const auto found = sources.find(signal); found != sources.end())
      return Source(name, signal, found->second, header);
    if (Contains(header, signal)) return Source(name, signal, {signal, 1.0, 0.0, ""}, header);
    return std::nullopt;
  };
  std::vector<std::string> numbers, texts;
  const auto want = [&](const std::optional<Source>& source) {
    if (!source) return;
    for (const std::string& column : source->columns())
      if (!Contains(numbers, column)) numbers.push_back(column);
  };
  const std::optional<Source> time = file.rate_hz > 0.0 ? std::nullopt : source_of("t");
  if (!time && file.rate_hz == 0.0)
    throw ConfigError(name + ": columns.t: which column is the time? Or say rate_hz = .. where there is none");
  want(time);
  std::vector<std::optional<Source>> signals;
  for (const SignalDescription& signal : plant.signals) {
    signals.push_back(source_of(signal.name));
    if (!signals.back() && signal.derivative_of.empty())
      throw ConfigError(name + ": columns." + signal.name + ": which column is it? " + csv_path.filename().string() +
                        " has no column of that name" + DidYouMean(signal.name, header));
    want(signals.back());
  }
  if (!file.segment_column.empty()) texts.push_back(file.segment_column);
  for (const auto& [column, words] : file.only)
    if (!Contains(texts, column)) texts.push_back(column);
  const CsvColumns csv = ReadCsvColumns(csv_path, numbers, texts, skip_bad);

  std::vector<double> t;
  if (time) {
    t = time->Values(csv);
  } else {
    for (std::size_t n = 0; n < csv.num_rows(); ++n) t.push_back(static_cast<double>(n) / file.rate_hz);
  }
  std::vector<std::vector<double>> values;
  for (const auto& signal : signals) values.push_back(signal ? signal->Values(csv) : std::vector<double>());

  const Selection selection(file, csv);
  RecordingRows rows;
  rows.signal.resize(plant.signals.size());
  rows.skipped = csv.skipped;
  std::size_t before = 0;
  for (std::size_t n = 0; n < csv.num_rows(); ++n) {
    if (!selection.Uses(n, t[n])) continue;
    const bool first = rows.t.empty();
    const bool other_segment = !first && selection.Segment(n) != selection.Segment(before);
    if (!first && !other_segment && t[n] <= t[before])
      throw InputError(csv_path.string() + ":" + std::to_string(csv.line[n]) + ": t = " + ExactNumber(t[n]) +
                       ": expected more than " + ExactNumber(t[before]) +
                       " of the row before; where another run begins, say [rows] segment_column");
    rows.t.push_back(t[n]);
    rows.new_run.push_back(first || other_segment ? 1 : 0);
    rows.held_out.push_back(selection.HoldsOut(n, t[n]) ? 1 : 0);
    for (std::size_t s = 0; s < values.size(); ++s) {
      if (values[s].empty()) continue;
      if (!std::isfinite(values[s][n]))
        throw InputError(csv_path.string() + ":" + std::to_string(csv.line[n]) + ": " + plant.signals[s].name +
                         " is not finite");
      rows.signal[s].push_back(values[s][n]);
    }
    before = n;
  }
  if (rows.t.size() < 10)
    throw ConfigError(name + ": uses " + std::to_string(rows.t.size()) + " rows of " + csv_path.string() +
                      ", at least 10 are needed; see [rows]");
  return rows;
}

}  // namespace armcmc::support
