#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "armcmc/log_export/log_scan.hpp"

namespace armcmc::log_export {

/// What to write.
struct ExportRequest {
  std::filesystem::path log;
  std::filesystem::path out;          ///< Folder, made when it is missing; files in it are replaced.
  std::string prefix;                 ///< Only channels that begin so; empty: all.
  std::vector<std::string> channels;  ///< Only these, with or without prefix; empty: all.
  bool long_histograms = false;       ///< Posteriors: a row a bin instead of a row a message.
};

/// One table that was written.
struct ExportedTable {
  ChannelScan channel;
  std::filesystem::path file;
  std::int64_t rows = 0;
};

struct ExportSummary {
  std::vector<ExportedTable> tables;
  std::vector<ChannelScan> foreign;  ///< Channels without a message of ours.
  std::int64_t left_out = 0;         ///< Channels that were not asked for.
  support::LcmLogDamage damage;
};

/// Writes one CSV a channel: the first column "t [s]" is the time since the first event of the log, which is the same
/// for all tables, then one column a number. Doubles read back to the bit. Samples of a pack have rows of their own,
/// timed by the sample interval.
/// @param on_progress  Called with the share done.
/// @throws support::InputError for a file that is no log, a channel that is not in it, or nothing to write.
/// @throws std::runtime_error when a file cannot be written.
ExportSummary ExportLog(const ExportRequest& request, const std::function<void(double)>& on_progress);

}  // namespace armcmc::log_export
