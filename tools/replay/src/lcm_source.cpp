#include "armcmc/replay/lcm_source.hpp"

#include <array>
#include <cstdint>
#include <numeric>
#include <set>
#include <utility>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/data_pack_v2_t.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/rt/pack_codec.hpp"
#include "armcmc/rt/sequence_tracker.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::replay {
namespace {

rt::PackFormat FormatOf(const SourceRequest& request) {
  rt::PackFormat format{.plant = request.plant, .num_inputs = request.num_inputs, .overlap = request.overlap};
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
  throw support::InputError(path.string() + ": contains no event of channel " + channel + " (--prefix?); it has " +
                            names);
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

std::string DescribedPlantOfLog(const std::filesystem::path& path, const std::string& prefix) {
  support::LcmLogReader log(path);
  support::LcmLogEvent event;
  data_pack_v2_t pack{};
  std::string plant;
  while (log.Next(&event)) {
    if (event.channel == prefix + "PLANT_PACK") return "";
    if (!plant.empty() || event.channel != prefix + "PLANT_PACK_V2") continue;
    if (pack.decode(event.data.data(), 0, static_cast<int>(event.data.size())) < 0) continue;
    for (const std::uint8_t c : pack.plant)
      if (c != 0) plant.push_back(static_cast<char>(c));
  }
  return plant;
}

struct LcmSource::Checks {
  rt::PackCodec codec;
  rt::SequenceTracker tracker;
  std::array<std::int64_t, rt::kNumRejectCauses> rejected{};  ///< By cause.
};

LcmSource::LcmSource(const SourceRequest& request, std::optional<DrawRecord> record)
    : channel_(request.prefix + FormatOf(request).channel()),
      log_(request.data),
      record_(std::move(record)),
      checks_(std::make_unique<Checks>(Checks{rt::PackCodec(FormatOf(request)), {}, {}})) {
  RequireChannel(request.data, channel_);
}

LcmSource::~LcmSource() = default;

bool LcmSource::Next(RecordedPack* next) {
  support::LcmLogEvent event;
  while (log_.Next(&event)) {
    if (event.channel != channel_) continue;
    rt::PackCodec& codec = checks_->codec;
    if (const rt::RejectCause cause = codec.Decode(event.data); cause != rt::RejectCause::kNone) {
      ++checks_->rejected[static_cast<std::size_t>(cause)];
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
  const std::int64_t rejected = std::accumulate(checks_->rejected.begin(), checks_->rejected.end(), std::int64_t{0});
  return {seen.lost, seen.duplicate, seen.reordered, rejected, unused_};
}

std::vector<std::string> LcmSource::notes() const {
  std::vector<std::string> notes;
  if (log_.damage().any()) notes.push_back("the log is damaged: " + ToString(log_.damage()));
  for (std::size_t cause = 0; cause < checks_->rejected.size(); ++cause)
    if (checks_->rejected[cause] > 0)
      notes.push_back("rejected " + std::to_string(checks_->rejected[cause]) + ": " +
                      std::string(rt::ToString(static_cast<rt::RejectCause>(cause))));
  if (record_)
    notes.push_back("draws are cut where " + std::to_string(record_->size()) + " recorded estimates were" +
                    (unused_ > 0 ? "; " + std::to_string(unused_) + " packs that have none are left out" : ""));
  return notes;
}

}  // namespace armcmc::replay
