#include "armcmc/replay/lcm_source.hpp"

#include <set>
#include <utility>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/rt/pack_codec.hpp"
#include "armcmc/rt/sequence_tracker.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::replay {
namespace {

rt::PackFormat FormatOf(const SourceRequest& request) {
  rt::PackFormat format{.plant = request.plant, .num_inputs = request.num_inputs};
  if (request.described != nullptr) {
    format.name = request.described->plant().description().name;
    format.fingerprint = request.described->plant().fingerprint();
  }
  return format;
}

void RequireChannel(const std::filesystem::path& path, const std::string& channel) {
  support::LcmLogReader log(path);
  support::LcmLogEvent event;
  std::set<std::string> seen;
  while (log.Next(&event)) {
    if (event.channel == channel) return;
    seen.emplace(event.channel);
  }
  std::string names;
  for (const std::string& name : seen) names += (names.empty() ? "" : ", ") + name;
  throw support::InputError(path.string() + ": holds no event of channel " + channel + " (--prefix?); it has " + names);
}

}  // namespace

const ModelInfo& ModelOfLog(const std::filesystem::path& path, const std::string& prefix) {
  const std::string channel = prefix + "PLANT_PACK";
  RequireChannel(path, channel);
  support::LcmLogReader log(path);
  support::LcmLogEvent event;
  data_pack_t pack{};
  while (log.Next(&event)) {
    if (event.channel != channel) continue;
    if (pack.decode(event.data.data(), 0, static_cast<int>(event.data.size())) < 0) continue;
    if (const ModelInfo* model = ModelOf(PlantNumber{pack.plant_kind}); model != nullptr) return *model;
  }
  throw support::InputError(path.string() + ": no event of " + channel + " is a pack of a known type and plant");
}

struct LcmSource::Checks {
  rt::PackCodec codec;
  rt::SequenceTracker tracker;
};

LcmSource::LcmSource(const SourceRequest& request, std::optional<DrawRecord> record)
    : channel_(request.prefix + FormatOf(request).channel()),
      log_(request.data),
      record_(std::move(record)),
      checks_(std::make_unique<Checks>(Checks{rt::PackCodec(FormatOf(request)), {}})) {
  RequireChannel(request.data, channel_);
}

LcmSource::~LcmSource() = default;

bool LcmSource::Next(RecordedPack* next) {
  support::LcmLogEvent event;
  while (log_.Next(&event)) {
    if (event.channel != channel_) continue;
    rt::PackCodec& codec = checks_->codec;
    if (codec.Decode(event.data) != rt::RejectCause::kNone) {
      ++rejected_;
      if (codec.decoded()) checks_->tracker.OnUnusable(codec.seq(), codec.run_id());
      continue;
    }
    if (!rt::IsUsable(checks_->tracker.OnPack(codec.seq(), codec.run_id()).verdict)) continue;
    next->limits = kNoDrawLimits;
    if (record_) {
      const std::optional<DrawLimits> limits = record_->Find(codec.run_id(), codec.seq());
      if (!limits) {
        ++unused_;
        continue;
      }
      next->limits = *limits;
    }
    codec.CopyTo(&next->pack);
    const DataPack& pack = next->pack;
    for (int n = 0; n < pack.num_samples; ++n)
      next->t[static_cast<std::size_t>(n)] = pack.t_last_s - (pack.num_samples - 1 - n) * pack.dt;
    return true;
  }
  return false;
}

PackCounts LcmSource::counts() const {
  const rt::SequenceTracker::Counts& seen = checks_->tracker.counts();
  return {seen.lost, seen.duplicate, seen.reordered, rejected_, unused_};
}

std::vector<std::string> LcmSource::notes() const {
  std::vector<std::string> notes;
  if (log_.damage().any()) notes.push_back("the log is damaged: " + ToString(log_.damage()));
  if (record_)
    notes.push_back("draws are cut where " + std::to_string(record_->size()) + " recorded estimates were" +
                    (unused_ > 0 ? "; " + std::to_string(unused_) + " packs that have none are left out" : ""));
  return notes;
}

}  // namespace armcmc::replay
