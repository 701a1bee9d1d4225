#include "recording_rows.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "armcmc/expression/check.hpp"
#include "armcmc/expression/features.hpp"
#include "armcmc/expression/graph.hpp"
#include "armcmc/support/csv.hpp"
#include "armcmc/support/program.hpp"
#include "csv_columns.hpp"
#include "csv_text.hpp"
#include "nearest.hpp"

namespace armcmc::support {
namespace {

namespace fs = std::filesystem;

bool Contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string NoColumn(const std::string& column, const fs::path& csv, const std::vector<std::string>& header) {
  return csv.string() + " has no column " + column + DidYouMean(column, header) + "; its header has " +
         JoinedNames(header) + HeaderHint(header);
}

/// Which columns an expression could have meant by an unknown name.
std::string ColumnFor(const std::string& name, const fs::path& csv, const std::vector<std::string>& header) {
  std::vector<std::string> columns;
  std::copy_if(header.begin(), header.end(), std::back_inserter(columns),
               [](const std::string& column) { return expression::IsFreeName(column); });
  return DidYouMean(name, columns) + "; columns of " + csv.string() +
         " that an expression can name: " + (columns.empty() ? "none" : JoinedNames(columns));
}

/// What a source says, with the columns that it reads.
class Source {
 public:
  Source(const ColumnSource& source, const fs::path& csv, const std::vector<std::string>& header) : source_(source) {
    if (source.value.empty()) {
      columns_ = {source.column};
      if (source.table && !Contains(header, source.column))
        throw source.table->Error(source.key, NoColumn(source.column, csv, header));
      return;
    }
    try {
      Compile(csv, header);
    } catch (const expression::Error& error) {
      throw source.table->ErrorInText(source.key, error.column(), error.what());
    }
  }

  [[nodiscard]] const std::vector<std::string>& columns() const noexcept { return columns_; }
  /// What one unit of the column is; of a column as it stands.
  [[nodiscard]] double scale() const noexcept { return source_.scale; }
  /// A column as it stands, which no signal is made of.
  [[nodiscard]] bool counts_alone(const std::vector<std::optional<Source>>& signals) const {
    return source_.value.empty() && source_.scale != 0.0 &&
           std::none_of(signals.begin(), signals.end(),
                        [&](const auto& signal) { return signal && Contains(signal->columns(), columns_.front()); });
  }

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
  void Compile(const fs::path& csv, const std::vector<std::string>& header) {
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
    expression::Meaning meaning;
    try {
      meaning = Check(syntax, scope);
    } catch (const expression::UnknownName& error) {
      throw expression::Error(error.column(), error.what() + ColumnFor(error.name(), csv, header));
    }
    if (meaning.memory) throw expression::Error(1, "a column is made row by row: no function with memory");
    expression::Graph graph;
    const int node = graph.Lower(syntax, scope, {});
    program_ = expression::FeatureProgram(graph, {node});
  }

  ColumnSource source_;
  std::vector<std::string> columns_;
  expression::FeatureProgram program_;
};

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

/// What becomes of the empty cells of the columns that are read.
class Blanks {
 public:
  /// @param output_columns  Columns that the output is made of, whose cells are never made up.
  Blanks(BlankPolicy blanks, const std::vector<std::string>& output_columns, const std::vector<double>& t,
         const Selection& selection, CsvColumns* csv)
      : unusable_(csv->num_rows(), false) {
    if (blanks == BlankPolicy::kErrors) return;
    for (auto& [name, cells] : csv->number) {
      if (blanks == BlankPolicy::kInterpolated && !Contains(output_columns, name)) Fill(t, selection, *csv, &cells);
      for (std::size_t n = 0; n < cells.size(); ++n)
        if (std::isnan(cells[n]) && !csv->bad.contains(n)) unusable_[n] = true;
    }
  }
  [[nodiscard]] bool Lacks(std::size_t row) const { return unusable_[row]; }
  [[nodiscard]] std::vector<std::string> notes() const {
    std::vector<std::string> notes;
    const auto rows = std::count(unusable_.begin(), unusable_.end(), true);
    if (rows > 0) notes.push_back(std::to_string(rows) + " rows with blank cells are left out");
    if (filled_ > 0) notes.push_back(std::to_string(filled_) + " blank cells are interpolated");
    return notes;
  }

 private:
  /// Between values of one segment that are not further apart than several of its usual intervals.
  void Fill(const std::vector<double>& t, const Selection& selection, const CsvColumns& csv,
            std::vector<double>* cells) {
    constexpr double kGap = 4.5;
    std::vector<std::size_t> known;
    for (std::size_t n = 0; n < cells->size(); ++n)
      if (!std::isnan((*cells)[n])) known.push_back(n);
    std::vector<double> intervals;
    for (std::size_t i = 1; i < known.size(); ++i) intervals.push_back(t[known[i]] - t[known[i - 1]]);
    if (intervals.empty()) return;
    const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
    std::nth_element(intervals.begin(), middle, intervals.end());
    const double longest = kGap * *middle;
    for (std::size_t i = 1; i < known.size(); ++i) {
      const std::size_t from = known[i - 1], to = known[i];
      const double length = t[to] - t[from];
      if (!(length > 0.0 && length <= longest) || selection.Segment(from) != selection.Segment(to)) continue;
      for (std::size_t n = from + 1; n < to; ++n) {
        if (csv.bad.contains(n)) continue;
        (*cells)[n] = (*cells)[from] + ((*cells)[to] - (*cells)[from]) * (t[n] - t[from]) / length;
        ++filled_;
      }
    }
  }

  std::vector<bool> unusable_;
  std::size_t filled_ = 0;
};

/// Words that a column is asked for and does not have.
void RequireWords(const StrictTable& table, const std::string& key, const std::vector<std::string>& words,
                  const std::vector<std::string>& cells) {
  const std::set<std::string> there(cells.begin(), cells.end());
  for (const std::string& word : words) {
    if (there.contains(word)) continue;
    constexpr std::size_t kMaxShown = 12;
    std::vector<std::string> shown(there.begin(), there.end());
    const std::string hint = DidYouMean(word, shown);
    const bool all = shown.size() <= kMaxShown;
    if (!all) shown.resize(kMaxShown);
    std::string problem = "no row has \"";
    problem.append(word).append("\"").append(hint).append("; available: ").append(JoinedNames(shown));
    throw table.Error(key, problem + (all ? "" : ",.."));
  }
}

/// The columns of text that the file speaks of, and what it expects to find there.
std::vector<std::string> TextColumns(const RecordingFile& file, const fs::path& csv,
                                     const std::vector<std::string>& header) {
  std::vector<std::string> texts;
  if (!file.segment_column.empty()) {
    if (!Contains(header, file.segment_column))
      throw StrictTable(*file.root).Table("rows").Error("segment_column", NoColumn(file.segment_column, csv, header));
    texts.push_back(file.segment_column);
  }
  for (const auto& [column, words] : file.only) {
    if (!Contains(header, column))
      throw StrictTable(*file.root).Table("rows").Table("only").Error(column, NoColumn(column, csv, header));
    if (!Contains(texts, column)) texts.push_back(column);
  }
  return texts;
}

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
  notes.insert(notes.end(), other.notes.begin(), other.notes.end());
}

RecordingRows ReadRecordingRows(const std::filesystem::path& csv_path, const RecordingFile& file,
                                const std::map<std::string, ColumnSource>& sources, const PlantDescription& plant,
                                const std::string& name, bool skip_bad) {
  const std::vector<std::string> header = ReadCsvHeader(csv_path);
  const auto source_of = [&](const std::string& signal) -> std::optional<Source> {
    if (const auto found = sources.find(signal); found != sources.end()) return Source(found->second, csv_path, header);
    if (Contains(header, signal)) return Source({.column = signal}, csv_path, header);
    if (signal == "t" && FindTime(header) != std::string::npos)
      return Source({.column = header[FindTime(header)]}, csv_path, header);
    return std::nullopt;
  };
  std::vector<std::string> numbers;
  const auto want = [&](const std::optional<Source>& source) {
    if (!source) return;
    for (const std::string& column : source->columns())
      if (!Contains(numbers, column)) numbers.push_back(column);
  };
  const std::optional<Source> time = file.rate_hz > 0.0 ? std::nullopt : source_of("t");
  if (!time && file.rate_hz == 0.0 && !file.root)
    throw ConfigError(NoColumn("t", csv_path, header) + ", expected t and the signals of " + plant.name +
                      "; a recording file gives the columns of other names");
  if (!time && file.rate_hz == 0.0)
    throw StrictTable(*file.root)
        .Table("columns")
        .Error("t", "which column is the time? Or say rate_hz = .. where there is none");
  want(time);
  std::vector<std::optional<Source>> signals;
  for (const SignalDescription& signal : plant.signals) {
    signals.push_back(source_of(signal.name));
    if (!signals.back() && signal.derivative_of.empty() && !file.root)
      throw ConfigError(NoColumn(signal.name, csv_path, header) + ", expected t and the signals of " + plant.name +
                        "; a recording file gives the columns of other names");
    if (!signals.back() && signal.derivative_of.empty())
      throw StrictTable(*file.root)
          .Table("columns")
          .Error(signal.name, "which column is it? " + NoColumn(signal.name, csv_path, header));
    want(signals.back());
  }
  const std::vector<std::string> texts = TextColumns(file, csv_path, header);
  const BadRowPolicy bad_rows = skip_bad    ? BadRowPolicy::kSkipped
                                : file.root ? BadRowPolicy::kKept
                                            : BadRowPolicy::kErrors;
  TimeColumn time_column;
  if (time && time->counts_alone(signals)) time_column = {time->columns().front(), kFarTime / std::fabs(time->scale())};
  CsvColumns csv = ReadCsvColumns(csv_path, numbers, texts, bad_rows, time_column, file.blanks == BlankPolicy::kErrors);
  for (const auto& [column, words] : file.only)
    RequireWords(StrictTable(*file.root).Table("rows").Table("only"), column, words, csv.text.at(column));
  if (!file.held_out.segments.empty() && file.held_out.file.empty())
    RequireWords(StrictTable(*file.root).Table("held_out"), "segments", file.held_out.segments,
                 csv.text.at(file.segment_column));

  std::vector<double> t;
  if (time) {
    t = time->Values(csv);
  } else {
    for (std::size_t n = 0; n < csv.num_rows(); ++n) t.push_back(static_cast<double>(n) / file.rate_hz);
  }
  // What times that count from the first one count from.
  const double start = time && csv.start != 0.0 ? csv.start * time->scale() : 0.0;
  const Selection selection(file, csv);
  std::vector<std::string> output_columns;
  for (std::size_t s = 0; s < signals.size(); ++s)
    if (plant.signals[s].name == plant.output && signals[s]) output_columns = signals[s]->columns();
  const Blanks blanks(file.blanks, output_columns, t, selection, &csv);
  std::vector<std::vector<double>> values;
  values.reserve(signals.size());
  for (const auto& signal : signals) values.push_back(signal ? signal->Values(csv) : std::vector<double>());

  RecordingRows rows;
  rows.signal.resize(plant.signals.size());
  rows.skipped = csv.skipped;
  rows.in_file = csv.num_rows();
  rows.notes = blanks.notes();
  if (start != 0.0) rows.notes.push_back("times count from the first one, " + ExactNumber(start) + " s");
  std::size_t before = 0;
  for (std::size_t n = 0; n < csv.num_rows(); ++n) {
    if (blanks.Lacks(n) || !selection.Uses(n, start + t[n])) continue;
    if (const auto bad = csv.bad.find(n); bad != csv.bad.end())
      throw InputError(csv_path.string() + ":" + std::to_string(csv.line[n]) + ": " + bad->second +
                       "; [rows] drop = [[" + std::to_string(n) + ", " + std::to_string(n + 1) +
                       "]] leaves the row out");
    const bool first = rows.t.empty();
    const bool other_segment = !first && selection.Segment(n) != selection.Segment(before);
    if (!first && !other_segment && t[n] <= t[before])
      throw InputError(csv_path.string() + ":" + std::to_string(csv.line[n]) + ": t = " + ExactNumber(t[n]) +
                       ": expected more than " + ExactNumber(t[before]) +
                       " of the row before; where another run begins, say [rows] segment_column");
    rows.t.push_back(t[n]);
    rows.new_run.push_back(first || other_segment ? 1 : 0);
    rows.held_out.push_back(selection.HoldsOut(n, start + t[n]) ? 1 : 0);
    for (std::size_t s = 0; s < values.size(); ++s) {
      if (values[s].empty()) continue;
      if (!std::isfinite(values[s][n]))
        throw InputError(csv_path.string() + ":" + std::to_string(csv.line[n]) + ": " + plant.signals[s].name +
                         " is not finite");
      rows.signal[s].push_back(values[s][n]);
    }
    before = n;
  }
  if (rows.t.size() < 10) {
    const std::string problem = "uses " + std::to_string(rows.t.size()) + " rows of the " +
                                std::to_string(csv.num_rows()) + " of " + csv_path.string() +
                                ", at least 10 are needed";
    if (file.root) throw StrictTable(*file.root).Error("rows", problem);
    throw ConfigError(name + ": " + problem);
  }
  return rows;
}

}  // namespace armcmc::support
