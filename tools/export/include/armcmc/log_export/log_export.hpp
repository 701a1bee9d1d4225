#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "armcmc/log_export/log_scan.hpp"

namespace armcmc::log_export {

enum class ExportFormat : std::uint8_t {
  kCsv,   ///< A folder of tables, one a channel.
  kMcap,  ///< One file with a topic a channel.
};

/// What to write.
struct ExportRequest {
  std::filesystem::path log;
  std::filesystem::path
      out;  ///< Folder of the tables, made when it is missing, or the MCAP file. What is there is replaced.
  ExportFormat format = ExportFormat::kCsv;
  std::string prefix;                 ///< Only channels that begin so; empty: all.
  std::vector<std::string> channels;  ///< Only these, with or without prefix; empty: all.
  bool long_histograms = false;       ///< Posteriors: a row a bin instead of a row a message.
};

/// One channel that was written.
struct ExportedTable {
  ChannelScan channel;
  std::filesystem::path file;
  std::int64_t rows = 0;  ///< Rows of its table, or messages of its topic.
};

struct ExportSummary {
  std::vector<ExportedTable> tables;
  std::vector<ChannelScan> foreign;  ///< Channels without a message of this project.
  std::int64_t left_out = 0;         ///< Channels that were not requested.
  support::LcmLogDamage damage;
};

/// Writes what a log holds, channel by channel, as rows: a message is one row, a pack one row a sample, timed by the
/// sample interval; samples that packs share are written once.
///
/// CSV: the first column "t [s]" is the time since the first event of the log, which is the same for all tables, then
/// one column per number. Doubles read back exactly.
/// MCAP: a row is a message in JSON with the names of the columns, nested at their dots; log_time is the event's time,
/// of a sample its own time on the clock of the log; publish_time is what the message says of it where that lies within
/// a second of log_time, else log_time. Numbers that are not finite are null.
/// @param on_progress  Called with the share done.
/// @throws support::InputError for a file that is not a log, a channel that is not in it, nothing to write, or an
/// output that cannot be written.
/// @throws std::runtime_error when writing fails.
ExportSummary ExportLog(const ExportRequest& request, const std::function<void(double)>& on_progress);

}  // namespace armcmc::log_export
