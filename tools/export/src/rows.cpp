#include "rows.hpp"

#include <algorithm>

#include "armcmc/log_export/meaning.hpp"

namespace armcmc::log_export {

Rows::Rows(const ChannelScan& channel, const PlantScan& plant, const std::vector<Column>& columns) : plant_(plant) {
  const auto meaning = Meanings().find(channel.type->name);
  per_sample_ = meaning != Meanings().end() && meaning->second.row_per_sample;
  for (const Column& column : columns)
    if (column.sample_stride > 0) room_ = std::max(room_, column.field->dims[0]);
}

void Rows::ForEach(std::span<const std::uint8_t> data, const MessageType& type, double t,
                   const std::function<void(double t, std::size_t sample)>& row) {
  if (!per_sample_) return row(t, 0);
  const auto integer = [&](const char* name) { return IntegerAt(data, *type.Find(name), 0); };
  const std::int64_t samples = std::clamp<std::int64_t>(integer("n_samples"), 0, room_);
  const std::int64_t run = integer("run_id"), seq = integer("seq");
  // The clock of the plant, which has no jitter, moved to the time of the log once a run.
  double dt = 0.0;
  if (const auto pack = plant_.packs.find({run, seq}); pack != plant_.packs.end()) {
    dt = pack->second.dt;
    t = plant_.start.at(run) + pack->second.t_last;
  }
  // Packs may overlap: their samples are written once.
  std::int64_t known = 0;
  if (dt > 0.0 && run == last_run_ && seq > last_seq_)
    while (known < samples && t - static_cast<double>(samples - 1 - known) * dt < last_t_ + 0.5 * dt) ++known;
  if (known == samples) known = 0;  // a clock that stands still says nothing
  last_run_ = run;
  last_seq_ = seq;
  last_t_ = t;
  for (std::int64_t n = known; n < samples; ++n)
    row(t - static_cast<double>(samples - 1 - n) * dt, static_cast<std::size_t>(n));
}

}  // namespace armcmc::log_export
