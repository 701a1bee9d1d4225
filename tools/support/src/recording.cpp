#include "armcmc/support/recording.hpp"

#include <algorithm>

#include "armcmc/support/plant_file.hpp"
#include "armcmc/support/plant_library.hpp"
#include "armcmc/support/program.hpp"
#include "recording_file.hpp"
#include "recording_rows.hpp"
#include "recording_signals.hpp"

namespace armcmc::support {
namespace fs = std::filesystem;
namespace {

/// Beside the recording file, or where the data are.
fs::path FindData(const fs::path& recording, const StrictTable& table, const std::string& file,
                  const fs::path& data_dir) {
  std::error_code error;
  std::vector<fs::path> places;
  if (!data_dir.empty()) places.push_back(data_dir / file);
  places.push_back(recording.parent_path() / file);
  std::string tried;
  for (const fs::path& place : places) {
    if (fs::is_regular_file(place, error)) return place;
    tried += (tried.empty() ? "" : " nor ") + place.string();
  }
  throw table.Error("file",
                    "there is no file " + tried + (data_dir.empty() ? "; --data-dir says where the data are" : ""));
}

/// The last rows of every record where nothing is said.
void HoldOutByDefault(std::vector<std::uint8_t>* held_out) {
  constexpr double kShare = 0.3;
  const auto count = static_cast<std::size_t>(kShare * static_cast<double>(held_out->size()));
  std::fill(held_out->end() - static_cast<std::ptrdiff_t>(count), held_out->end(), std::uint8_t{1});
}

/// Ranges of held_out that reach beyond the CSV: notes, with their place, where rows are left, else an error.
std::vector<std::string> HeldOutBeyond(const RecordingFile& file, std::size_t num_rows, const fs::path& csv) {
  std::vector<std::string> notes;
  const StrictTable table = StrictTable(*file.root).Table("held_out");
  const std::string has = "; " + csv.string() + " has the rows 0 to " + std::to_string(num_rows - 1);
  for (const RowRange& range : file.held_out.rows) {
    const bool open = range.until == HeldOut::kToTheEnd;
    const std::string key = open ? "from" : "rows";
    std::string text = std::to_string(range.from);
    if (!open) text.append(" to ").append(std::to_string(range.until - 1));
    if (range.from >= num_rows) throw table.Error(key, text.append(": there are no such rows").append(has));
    if (!open && range.until > num_rows)
      notes.emplace_back(table.Error(key, text.append(": clipped at the last row").append(has)).what());
  }
  return notes;
}

Recording Begin(const PlantDescription& plant, std::uint64_t fingerprint) {
  Recording recording;
  recording.plant = plant.name;
  recording.fingerprint = fingerprint;
  for (const SignalDescription& signal : plant.signals) {
    if (signal.name == plant.output) recording.output = recording.signals.size();
    recording.signals.push_back({signal.name, signal.unit, {}});
  }
  return recording;
}

}  // namespace

std::string RecordingModel(const fs::path& recording) {
  StrictTable root = StrictTable::FromFile(recording);
  std::string model = root.RequiredText("model");
  std::error_code error;
  const fs::path beside = recording.parent_path() / model;
  if (fs::is_regular_file(beside, error)) return beside.string();
  try {
    return FindPlantFile(model).string();
  } catch (const ConfigError& missing) {
    throw root.Error("model", missing.what());
  }
}

Recording ReadRecording(const fs::path& path, const fs::path& data_dir) {
  const std::string model = RecordingModel(path);
  const Plant plant = ReadPlant(model);
  const PlantDescription& description = plant.description();
  std::vector<std::string> names;
  for (const SignalDescription& signal : description.signals) names.push_back(signal.name);
  const RecordingFile file = ReadRecordingFile(path, names);
  Recording recording = Begin(description, plant.fingerprint());
  recording.title = file.title;
  recording.model = model;
  recording.published = file.published;

  recording.files = {FindData(path, *file.root, file.file, data_dir)};
  RecordingRows rows = ReadRecordingRows(recording.files.front(), file, file.columns, description, path.string(),
                                         /*skip_bad=*/false);
  if (!file.held_out.given) HoldOutByDefault(&rows.held_out);
  if (!file.held_out.file.empty() || !file.held_out.columns.empty()) {
    const std::string& other = file.held_out.file.empty() ? file.file : file.held_out.file;
    std::map<std::string, ColumnSource> sources = file.columns;
    for (const auto& [signal, source] : file.held_out.columns) sources[signal] = source;
    const StrictTable table = file.held_out.file.empty() ? *file.root : StrictTable(*file.root).Table("held_out");
    const fs::path data = FindData(path, table, other, data_dir);
    if (data != recording.files.front()) recording.files.push_back(data);
    RecordingRows second = ReadRecordingRows(data, file, sources, description, path.string(), /*skip_bad=*/false);
    std::fill(second.held_out.begin(), second.held_out.end(), std::uint8_t{1});
    rows.Append(second);
  }
  const auto held = static_cast<std::size_t>(std::count(rows.held_out.begin(), rows.held_out.end(), std::uint8_t{1}));
  if (held == rows.size()) throw file.root->Error("held_out", "nothing is left to fit to");
  if (held == 0) throw file.root->Error("held_out", "holds out no row that is used");
  const std::vector<std::string> beyond = HeldOutBeyond(file, rows.in_file, recording.files.front());
  recording.notes.insert(recording.notes.end(), beyond.begin(), beyond.end());
  recording.notes.insert(recording.notes.end(), rows.notes.begin(), rows.notes.end());
  Resample(rows, &recording);
  if (recording.t.empty())
    throw ConfigError(path.string() + ": every run has fewer than 10 rows; is segment_column right, or the time?");
  Derive(file, description, path.string(), &recording);
  return recording;
}

Recording ReadRecordedCsv(const fs::path& csv, const std::string& model, bool skip_bad) {
  const fs::path plant_file = FindPlantFile(model);
  const Plant plant = ReadPlant(plant_file);
  const PlantDescription& description = plant.description();
  Recording recording = Begin(description, plant.fingerprint());
  recording.title = csv.filename().string();
  recording.files = {csv};
  recording.model = plant_file.string();
  const RecordingFile file;
  RecordingRows rows = ReadRecordingRows(csv, file, {}, description, csv.string(), skip_bad);
  HoldOutByDefault(&rows.held_out);
  if (rows.skipped > 0) recording.notes.push_back("skipped " + std::to_string(rows.skipped) + " bad rows");
  recording.notes.insert(recording.notes.end(), rows.notes.begin(), rows.notes.end());
  Resample(rows, &recording);
  if (recording.t.empty()) throw ConfigError(csv.string() + ": every run has fewer than 10 rows");
  Derive(file, description, csv.string(), &recording);
  return recording;
}

}  // namespace armcmc::support
