#include "armcmc/log_export/log_scan.hpp"

#include <algorithm>

#include "armcmc/log_export/meaning.hpp"

namespace armcmc::log_export {
namespace {

using Bytes = std::span<const std::uint8_t>;

ChannelScan& ChannelOf(const support::LcmLogEvent& event, LogScan* scan) {
  for (ChannelScan& channel : scan->channels)
    if (channel.name == event.channel) return channel;
  ChannelScan channel;
  channel.name = event.channel;
  channel.fingerprint = FingerprintOf(event.data);
  return scan->channels.emplace_back(channel);
}

/// A_EST_ESTIMATE belongs to plant A_; a channel with a name of its own is a plant of its own.
std::string PrefixOf(const std::string& channel, const MessageType& type) {
  const auto meaning = Meanings().find(type.name);
  if (meaning == Meanings().end() || !channel.ends_with(meaning->second.channel)) return channel;
  return channel.substr(0, channel.size() - meaning->second.channel.size());
}

std::int64_t Integer(Bytes data, const MessageType& type, const char* field, std::int64_t fallback) {
  const MessageField* found = type.Find(field);
  return found == nullptr ? fallback : IntegerAt(data, *found, 0);
}

void NoteNames(Bytes data, const MessageType& type, PlantScan* plant) {
  const MessageField *name = type.Find("param_name"), *unit = type.Find("param_unit");
  if (name == nullptr || unit == nullptr || !plant->parameters.empty()) return;
  const std::int64_t count = std::clamp<std::int64_t>(Integer(data, type, "n_params", 0), 0, name->dims[0]);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    plant->parameters.push_back(TextAt(data, *name, i));
    plant->units.push_back(TextAt(data, *unit, i));
  }
}

void NoteModes(Bytes data, const MessageType& type, PlantScan* plant) {
  const MessageField* name = type.Find("mode_name");
  if (name == nullptr || !plant->modes.empty()) return;
  const std::int64_t count = std::clamp<std::int64_t>(Integer(data, type, "n_modes", 0), 0, name->dims[0]);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) plant->modes.push_back(TextAt(data, *name, i));
}

/// Packs of a described plant name their columns.
void NoteSignals(Bytes data, const MessageType& type, PlantScan* plant) {
  const MessageField *y = type.Find("y_name"), *y_unit = type.Find("y_unit"), *u = type.Find("u_name"),
                     *u_unit = type.Find("u_unit");
  if (y == nullptr || y_unit == nullptr || u == nullptr || u_unit == nullptr || !plant->output.empty()) return;
  plant->output = TextAt(data, *y, 0);
  plant->output_unit = TextAt(data, *y_unit, 0);
  const std::int64_t count = std::clamp<std::int64_t>(Integer(data, type, "n_inputs", 0), 0, u->dims[0]);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    plant->inputs.push_back(TextAt(data, *u, i));
    plant->input_units.push_back(TextAt(data, *u_unit, i));
  }
}

void NotePack(Bytes data, const MessageType& type, double t, PlantScan* plant) {
  const MessageField *t_last = type.Find("t_last_s"), *dt = type.Find("dt");
  if (t_last == nullptr || dt == nullptr) return;
  const std::int64_t run = Integer(data, type, "run_id", 0), seq = Integer(data, type, "seq", 0);
  const PlantScan::PackTime time = {NumberAt(data, *t_last, 0), NumberAt(data, *dt, 0)};
  plant->packs[{run, seq}] = time;
  plant->start.try_emplace(run, t - time.t_last);
}

void Note(const support::LcmLogEvent& event, const MessageType& type, double t, ChannelScan* channel,
          PlantScan* plant) {
  const auto largest = [&](const char* field, int* value) {
    *value = static_cast<int>(std::max<std::int64_t>(*value, Integer(event.data, type, field, 0)));
  };
  if (plant->plant_kind == 0) largest("plant_kind", &plant->plant_kind);
  largest("n_params", &channel->num_parameters);
  largest("n_bins", &channel->num_bins);
  largest("n_modes", &plant->num_modes);
  largest("n_inputs", &plant->num_inputs);
  NoteNames(event.data, type, plant);
  NoteModes(event.data, type, plant);
  NoteSignals(event.data, type, plant);
  NotePack(event.data, type, t, plant);
}

}  // namespace

LogScan ScanLog(const std::filesystem::path& path, const std::function<void(double)>& on_progress) {
  support::LcmLogReader log(path);
  support::LcmLogEvent event;
  LogScan scan;
  bool first = true;
  while (log.Next(&event)) {
    if (first) scan.first_utime = event.utime;
    first = false;
    ChannelScan& channel = ChannelOf(event, &scan);
    const MessageType* type = TypeOf(event.data);
    if (channel.type == nullptr && type != nullptr) {
      channel.type = type;
      channel.prefix = PrefixOf(channel.name, *type);
    }
    if (type == nullptr || type != channel.type) {
      ++channel.undecodable;
      continue;
    }
    ++channel.messages;
    const double t = 1e-6 * static_cast<double>(event.utime - scan.first_utime);
    Note(event, *type, t, &channel, &scan.plants[channel.prefix]);
    on_progress(log.progress());
  }
  scan.damage = log.damage();
  return scan;
}

}  // namespace armcmc::log_export
