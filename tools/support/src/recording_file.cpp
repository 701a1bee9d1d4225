#include "recording_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "nearest.hpp"

namespace armcmc::support {
namespace {

constexpr double kHuge = std::numeric_limits<double>::max();
constexpr auto kRows = static_cast<double>(HeldOut::kToTheEnd);

ColumnSource ReadSource(StrictTable& columns, const std::string& signal) {
  ColumnSource source;
  if (columns.IsText(signal)) {
    source.column = columns.RequiredText(signal);
    source.table = columns;
    source.key = signal;
    return source;
  }
  StrictTable table = columns.Table(signal);
  source.table = table;
  source.value = table.Text("value", "");
  source.key = source.value.empty() ? "column" : "value";
  if (!source.value.empty()) {
    for (const char* key : {"column", "scale", "offset"})
      if (table.Has(key)) throw table.Error(key, "does not go together with `value`, which is an expression");
    return source;
  }
  source.column = table.RequiredText("column");
  source.scale = table.Number("scale", 1.0, -kHuge, kHuge);
  source.offset = table.Number("offset", 0.0, -kHuge, kHuge);
  if (source.scale == 0.0) throw table.Error("scale", "must not be 0");
  return source;
}

std::map<std::string, ColumnSource> ReadSources(StrictTable columns, const std::vector<std::string>& signals) {
  std::map<std::string, ColumnSource> sources;
  for (const std::string& name : columns.Keys()) {
    if (name != "t" && std::find(signals.begin(), signals.end(), name) == signals.end())
      throw columns.Error(name, "is not a signal of the plant" + DidYouMean(name, signals));
    sources[name] = ReadSource(columns, name);
  }
  return sources;
}

std::vector<RowRange> ReadRanges(StrictTable& table, const char* key) {
  std::vector<RowRange> ranges;
  for (const std::vector<double>& pair : table.NumberLists(key, 2, 0.0, kRows)) {
    if (!(pair[0] < pair[1])) throw table.Error(key, "expected [first row, row after the last], as in [[0, 15]]");
    ranges.push_back({static_cast<std::size_t>(pair[0]), static_cast<std::size_t>(pair[1])});
  }
  return ranges;
}

/// A number that may be left out.
std::optional<double> ReadOptional(StrictTable& table, const char* key) {
  const double value = table.Number(key, 0.0, -kHuge, kHuge);  // asked for also where it is absent: then it is known
  return table.Has(key) ? std::optional(value) : std::nullopt;
}

void ReadRows(StrictTable rows, RecordingFile* file) {
  constexpr auto kMost = static_cast<std::int64_t>(kRows);
  RowRange range;
  range.from = static_cast<std::size_t>(rows.Integer("from", 0, 0, kMost));
  range.until = static_cast<std::size_t>(rows.Integer("until", kMost, 1, kMost));
  if (range.from >= range.until) throw rows.Error("until", "must be above `from`");
  if (rows.Has("from") || rows.Has("until")) file->rows = range;
  file->from_s = ReadOptional(rows, "from_s");
  file->until_s = ReadOptional(rows, "until_s");
  if (file->from_s && file->until_s && *file->from_s >= *file->until_s)
    throw rows.Error("until_s", "must be above `from_s`");
  for (const auto& [number, second] : {std::pair{"from", "from_s"}, {"until", "until_s"}})
    if (rows.Has(number) && rows.Has(second))
      throw rows.Error(second, std::string("does not go together with `") + number + "`: a row or a time, not both");
  file->drop = ReadRanges(rows, "drop");
  file->every = static_cast<std::size_t>(rows.Integer("every", 1, 1, 1'000'000));
  const std::string blanks = rows.Choice("blanks", "refuse", {"refuse", "skip", "interpolate"});
  file->blanks = blanks == "skip"          ? BlankPolicy::kSkipped
                 : blanks == "interpolate" ? BlankPolicy::kInterpolated
                                           : BlankPolicy::kErrors;
  file->segment_column = rows.Text("segment_column", "");
  StrictTable only = rows.Table("only");
  for (const std::string& column : only.Keys()) file->only[column] = only.Texts(column);
}

void ReadHeldOut(StrictTable& root, const std::vector<std::string>& signals, RecordingFile* file) {
  HeldOut& held = file->held_out;
  held.given = root.Has("held_out");
  StrictTable table = root.Table("held_out");
  const auto from = static_cast<std::size_t>(table.Integer("from", 0, 0, static_cast<std::int64_t>(kRows)));
  if (table.Has("from")) held.rows.push_back({from, HeldOut::kToTheEnd});
  held.from_s = ReadOptional(table, "from_s");
  const std::vector<RowRange> rows = ReadRanges(table, "rows");
  held.rows.insert(held.rows.end(), rows.begin(), rows.end());
  held.segments = table.Texts("segments");
  if (!held.segments.empty() && file->segment_column.empty())
    throw table.Error("segments", "needs [rows] segment_column, which says what a segment is");
  held.file = table.Text("file", "");
  held.columns = ReadSources(table.Table("columns"), signals);
  const bool any =
      held.from_s || !held.rows.empty() || !held.segments.empty() || !held.file.empty() || !held.columns.empty();
  if (held.given && !any)
    throw root.Error("held_out", "is empty; expected from, from_s, rows, segments, file or columns");
}

}  // namespace

RecordingFile ReadRecordingFile(const std::filesystem::path& path, const std::vector<std::string>& signals) {
  StrictTable root = StrictTable::FromFile(path);
  RecordingFile file;
  root.RequireSchema();
  file.title = root.Text("title", path.stem().string());
  file.model = root.RequiredText("model");
  file.file = root.RequiredText("file");
  file.columns = ReadSources(root.Table("columns"), signals);
  file.rate_hz = root.Number("rate_hz", 0.0, 1e-9, 1e9);
  if (file.rate_hz > 0.0 && file.columns.count("t") > 0)
    throw root.Error("rate_hz", "contradicts [columns] t: the time column gives the sample rate");
  ReadRows(root.Table("rows"), &file);
  StrictTable derivatives = root.Table("derivatives");
  file.bandwidth_hz = derivatives.Number("bandwidth_hz", 0.0, 1e-9, 1e9);
  file.filtered_with = derivatives.Texts("filtered_with");
  for (const std::string& name : file.filtered_with)
    if (std::find(signals.begin(), signals.end(), name) == signals.end())
      throw derivatives.Error("filtered_with", name + " is not a signal of the plant" + DidYouMean(name, signals));
  ReadHeldOut(root, signals, &file);
  for (StrictTable& published : root.Tables("published")) {
    PublishedFigure figure;
    figure.what = published.RequiredText("what");
    figure.value = published.RequiredNumber("value", -kHuge, kHuge);
    figure.source = published.Text("source", "");
    file.published.push_back(std::move(figure));
  }
  root.Finish();
  file.root = root;
  return file;
}

}  // namespace armcmc::support
