#include "armcmc/log_export/log_export.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>

#include "armcmc/log_export/mcap_writer.hpp"
#include "armcmc/support/program.hpp"
#include "csv_table.hpp"
#include "mcap_topic.hpp"

namespace armcmc::log_export {
namespace {

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
  for (const ChannelScan& channel : scan.channels) names.append(names.empty() ? "" : ", ").append(channel.name);
  for (const std::string& wanted : request.channels) {
    const bool there = std::any_of(scan.channels.begin(), scan.channels.end(), [&](const ChannelScan& channel) {
      return channel.type != nullptr && channel.name.starts_with(request.prefix) &&
             (channel.name == wanted || channel.name == channel.prefix + wanted);
    });
    if (there) continue;
    std::string problem = request.log.string();
    problem.append(": holds nothing readable on channel ").append(wanted).append("; it has ").append(names);
    throw support::InputError(problem);
  }
}

/// The MCAP file while it is written: under another name, so that an incomplete one is never taken for it.
class McapFile {
 public:
  McapFile(const ExportRequest& request, std::int64_t first_utime)
      : path_(request.out),
        partial_(Partial(request)),
        writer_(partial_, "armcmc-export " + support::Version()),
        topics_(&writer_, first_utime) {}
  ~McapFile() {
    std::error_code ignored;
    std::filesystem::remove(partial_, ignored);
  }
  McapFile(const McapFile&) = delete;
  McapFile& operator=(const McapFile&) = delete;

  McapTopics& topics() { return topics_; }
  void Close() {
    writer_.Close();
    std::filesystem::rename(partial_, path_);
  }

 private:
  static std::filesystem::path Partial(const ExportRequest& request) {
    std::error_code error;
    if (std::filesystem::is_directory(request.out, error))
      throw support::InputError(request.out.string() + ": is a folder, expected the name of the MCAP file to write");
    if (std::filesystem::equivalent(request.out, request.log, error))
      throw support::InputError(request.out.string() + ": is the log itself");
    const std::filesystem::path folder = request.out.parent_path();
    if (!folder.empty()) std::filesystem::create_directories(folder);
    return request.out.string() + ".part";
  }

  std::filesystem::path path_, partial_;
  McapWriter writer_;
  McapTopics topics_;
};

}  // namespace

ExportSummary ExportLog(const ExportRequest& request, const std::function<void(double)>& on_progress) {
  const LogScan scan = ScanLog(request.log, [&](double share) { on_progress(0.3 * share); });
  RefuseUnknown(request, scan);
  ExportSummary summary;
  summary.damage = scan.damage;
  for (const ChannelScan& channel : scan.channels) {
    if (channel.type == nullptr) {
      summary.foreign.push_back(channel);
    } else if (!Wanted(channel, request)) {
      ++summary.left_out;
    } else {
      summary.tables.push_back({channel, request.out, 0});
    }
  }
  if (summary.tables.empty()) throw support::InputError(request.log.string() + ": holds no message to export");

  std::optional<McapFile> mcap;
  if (request.format == ExportFormat::kMcap) {
    mcap.emplace(request, scan.first_utime);
  } else {
    std::filesystem::create_directories(request.out);
  }
  std::set<std::string> taken;
  std::map<std::string, std::unique_ptr<Sink>, std::less<>> sinks;
  for (ExportedTable& table : summary.tables) {
    const PlantScan& plant = scan.plants.at(table.channel.prefix);
    if (mcap) {
      sinks[table.channel.name] = mcap->topics().New(table.channel, plant);
    } else {
      table.file = request.out / FileName(table.channel.name, &taken);
      sinks[table.channel.name] = NewCsvTable(table.channel, plant, table.file, request.long_histograms);
    }
  }

  support::LcmLogReader log(request.log);
  support::LcmLogEvent event;
  while (log.Next(&event)) {
    const auto sink = sinks.find(event.channel);
    if (sink == sinks.end()) continue;
    const auto scanned = std::find_if(summary.tables.begin(), summary.tables.end(),
                                      [&](const ExportedTable& t) { return t.channel.name == event.channel; });
    const MessageType* type = TypeOf(event.data);
    if (type == nullptr || type != scanned->channel.type) continue;
    sink->second->Write(event.data, *type, {event.utime, 1e-6 * static_cast<double>(event.utime - scan.first_utime)});
    on_progress(0.3 + 0.7 * log.progress());
  }
  for (ExportedTable& table : summary.tables) table.rows = sinks.at(table.channel.name)->Close();
  if (mcap) mcap->Close();
  return summary;
}

}  // namespace armcmc::log_export
