#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/log_export/message_type.hpp"
#include "armcmc/support/lcm_log.hpp"

namespace armcmc::log_export {

/// What a log holds on one channel.
struct ChannelScan {
  std::string name;
  const MessageType* type = nullptr;     ///< Of its first message that is one of ours; nullptr: a foreign channel.
  std::string prefix;                    ///< In front of the channel's own name: which plant it belongs to.
  std::int64_t messages = 0;             ///< Of that type.
  std::int64_t undecodable = 0;          ///< Of another type, or of none of ours.
  std::int64_t fingerprint = 0;          ///< Of the first message, whatever it was.
  int num_parameters = 0, num_bins = 0;  ///< Largest n_params and n_bins of its messages; 0: they have none.
};

/// What the messages of one prefix say about their plant.
struct PlantScan {
  int plant_kind = 0;
  int num_modes = 0, num_inputs = 0;
  std::vector<std::string> parameters, units;  ///< As the estimates name them.
  std::vector<std::string> modes;              ///< As the estimator names them; empty: it does not.
  std::string output, output_unit;             ///< As the packs name them; empty: they do not.
  std::vector<std::string> inputs, input_units;
  struct PackTime {
    double t_last = 0.0, dt = 0.0;  ///< s, plant time of the last sample, and sample interval.
  };
  std::map<std::pair<std::int64_t, std::int64_t>, PackTime> packs;  ///< By run_id and seq.
  std::map<std::int64_t, double> start;  ///< s since the start of the log, at plant time zero of a run_id.
};

/// First pass over a log: what can be exported, and under which names.
struct LogScan {
  std::int64_t first_utime = 0;             ///< us, of the first event: time zero of every table.
  std::vector<ChannelScan> channels;        ///< In order of appearance.
  std::map<std::string, PlantScan> plants;  ///< By prefix.
  support::LcmLogDamage damage;
};

/// @param on_progress  Called with the share read.
/// @throws support::InputError if the file is not a log.
[[nodiscard]] LogScan ScanLog(const std::filesystem::path& path, const std::function<void(double)>& on_progress);

}  // namespace armcmc::log_export
