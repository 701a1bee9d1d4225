#include "armcmc/log_export/csv_export.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <memory>
#include <set>
#include <span>
#include <stdexcept>

#include "armcmc/log_export/columns.hpp"
#include "armcmc/log_export/meaning.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::log_export {
namespace {

using Bytes = std::span<const std::uint8_t>;

template <typename Number>
void Append(Number value, std::string* row) {
  std::array<char, 32> text{};
  row->append(text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr);
}

void AppendText(const std::string& text, std::string* row) {
  const bool quoted = text.find_first_of(",\"") != std::string::npos;
  if (quoted) row->push_back('"');
  for (const char c : text) row->append(c == '"' ? 2 : 1, c);
  if (quoted) row->push_back('"');
}

bool IsReal(const MessageField& field) { return field.type == "double" || field.type == "float"; }

/// The table of one channel while it is written.
class Table {
 public:
  Table(const ChannelScan& channel, const PlantScan& plant, std::filesystem::path path, bool long_histograms)
      : plant_(plant), columns_(ColumnsOf(channel, plant)), path_(std::move(path)), file_(path_, std::ios::binary) {
    if (!file_) throw support::InputError(path_.string() + ": cannot be written");
    const auto meaning = Meanings().find(channel.type->name);
    per_sample_ = meaning != Meanings().end() && meaning->second.row_per_sample;
    long_ = long_histograms && channel.type->Find("density") != nullptr;
    row_ = "t [s]";
    if (long_) {
      row_ += ",seq,mode,parameter,unit,bin,from,to,density";
    } else {
      for (const Column& column : columns_) row_.append(",").append(column.header);
    }
    EndRow();
    rows_ = 0;
  }

  void Write(Bytes data, const MessageType& type, double t) {
    if (long_) {
      WriteHistograms(data, type, t);
    } else if (per_sample_) {
      WriteSamples(data, type, t);
    } else {
      WriteRow(data, t, 0);
    }
  }

  std::int64_t Close() {
    if (!file_.flush()) throw std::runtime_error(path_.string() + ": writing failed");
    return rows_;
  }

 private:
  void WriteRow(Bytes data, double t, std::size_t sample) {
    Append(t, &row_);
    for (const Column& column : columns_) {
      row_.push_back(',');
      const std::size_t index = column.index + sample * column.sample_stride;
      if (column.text) {
        AppendText(TextAt(data, *column.field, index), &row_);
      } else if (IsReal(*column.field)) {
        Append(NumberAt(data, *column.field, index), &row_);
      } else {
        Append(IntegerAt(data, *column.field, index), &row_);
      }
    }
    EndRow();
  }

  void WriteSamples(Bytes data, const MessageType& type, double t) {
    const auto integer = [&](const char* name) { return IntegerAt(data, *type.Find(name), 0); };
    int room = 0;
    for (const Column& column : columns_)
      if (column.sample_stride > 0) room = std::max(room, column.field->dims[0]);
    const std::int64_t samples = std::clamp<std::int64_t>(integer("n_samples"), 0, room);
    // The clock of the plant, which has no jitter, moved to the time of the log once a run.
    double dt = 0.0;
    if (const auto pack = plant_.packs.find({integer("run_id"), integer("seq")}); pack != plant_.packs.end()) {
      dt = pack->second.dt;
      t = plant_.start.at(integer("run_id")) + pack->second.t_last;
    }
    const std::int64_t run = integer("run_id"), seq = integer("seq");
    // Packs may overlap: their samples are written once.
    std::int64_t known = 0;
    if (dt > 0.0 && run == last_run_ && seq > last_seq_)
      while (known < samples && t - static_cast<double>(samples - 1 - known) * dt < last_t_ + 0.5 * dt) ++known;
    if (known == samples) known = 0;  // a clock that stands still says nothing
    last_run_ = run;
    last_seq_ = seq;
    last_t_ = t;
    for (std::int64_t n = known; n < samples; ++n)
      WriteRow(data, t - static_cast<double>(samples - 1 - n) * dt, static_cast<std::size_t>(n));
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
        Append(t, &row_);
        for (const std::int64_t value : {integer("seq"), integer("mode")}) row_.push_back(','), Append(value, &row_);
        row_.append(",").append(ParameterName(plant_, i)).append(",");
        AppendText(ParameterUnit(plant_, i), &row_);
        row_.push_back(',');
        Append(bin, &row_);
        const auto at = i * static_cast<std::size_t>(density.dims[1]) + static_cast<std::size_t>(bin);
        for (const double value : {lo + static_cast<double>(bin) * width, lo + static_cast<double>(bin + 1) * width,
                                   NumberAt(data, density, at)})
          row_.push_back(','), Append(value, &row_);
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
  std::filesystem::path path_;
  std::ofstream file_;
  std::string row_;
  bool per_sample_ = false, long_ = false;
  std::int64_t rows_ = 0;
  std::int64_t last_run_ = 0, last_seq_ = 0;  ///< Of a table with a row for each sample.
  double last_t_ = 0.0;
};

bool Wanted(const ChannelScan& channel, const ExportRequest& request) {
  if (!channel.name.starts_with(request.prefix)) return false;
  if (request.channels.empty()) return true;
  return std::any_of(request.channels.begin(), request.channels.end(), [&](const std::string& name) {
    return channel.name == name || channel.name == channel.prefix + name;
  });
}

/// A name of a channel may hold what a name of a file may not.
std::string FileName(const std::string& channel, std::set<std::string>* taken) {
  std::string name = channel;
  for (char& c : name)
    if (std::string_view("/\\:*?\"<>| .").find(c) != std::string_view::npos) c = '_';
  while (!taken->insert(name).second) name += "_";
  return name + ".csv";
}

void RefuseUnknown(const ExportRequest& request, const LogScan& scan) {
  std::string names;
  for (const ChannelScan& channel : scan.channels) names += (names.empty() ? "" : ", ") + channel.name;
  for (const std::string& wanted : request.channels) {
    const bool there = std::any_of(scan.channels.begin(), scan.channels.end(), [&](const ChannelScan& channel) {
      return channel.type != nullptr && channel.name.starts_with(request.prefix) &&
             (channel.name == wanted || channel.name == channel.prefix + wanted);
    });
    if (!there)
      throw support::InputError(request.log.string() + ": holds nothing readable on channel " + wanted + "; it has " +
                                names);
  }
}

}  // namespace

ExportSummary ExportLog(const ExportRequest& request, const std::function<void(double)>& on_progress) {
  const LogScan scan = ScanLog(request.log, [&](double share) { on_progress(0.3 * share); });
  RefuseUnknown(request, scan);
  ExportSummary summary;
  summary.damage = scan.damage;
  std::filesystem::create_directories(request.out);
  std::set<std::string> taken;
  std::map<std::string, std::unique_ptr<Table>, std::less<>> tables;
  for (const ChannelScan& channel : scan.channels) {
    if (channel.type == nullptr) {
      summary.foreign.push_back(channel);
    } else if (!Wanted(channel, request)) {
      ++summary.left_out;
    } else {
      const std::filesystem::path path = request.out / FileName(channel.name, &taken);
      tables[channel.name] =
          std::make_unique<Table>(channel, scan.plants.at(channel.prefix), path, request.long_histograms);
      summary.tables.push_back({channel, path, 0});
    }
  }
  if (tables.empty()) throw support::InputError(request.log.string() + ": holds no message to export");

  support::LcmLogReader log(request.log);
  support::LcmLogEvent event;
  while (log.Next(&event)) {
    const auto table = tables.find(event.channel);
    if (table == tables.end()) continue;
    const auto scanned = std::find_if(summary.tables.begin(), summary.tables.end(),
                                      [&](const ExportedTable& t) { return t.channel.name == event.channel; });
    const MessageType* type = TypeOf(event.data);
    if (type == nullptr || type != scanned->channel.type) continue;
    table->second->Write(event.data, *type, 1e-6 * static_cast<double>(event.utime - scan.first_utime));
    on_progress(0.3 + 0.7 * log.progress());
  }
  for (ExportedTable& table : summary.tables) table.rows = tables.at(table.channel.name)->Close();
  return summary;
}

}  // namespace armcmc::log_export
