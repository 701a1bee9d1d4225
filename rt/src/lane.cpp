#include "armcmc/rt/lane.hpp"

#include <algorithm>

namespace armcmc::rt {

Lane::Lane(const RtSettings& settings, const LanePlant& plant, Injection* injection)
    : engine_(plant.engine),
      prefix_(plant.prefix),
      monitor_(settings),
      publisher_(ParseLcmUrl(settings.lcm_url), plant.prefix),
      collect_(settings, engine_->pack_format(), &packs_, &counters_, &events_[0]),
      adjust_(settings, engine_, &packs_, &results_, &monitor_, &counters_, &events_[1]),
      execute_(engine_, &results_, &outputs_, &monitor_, &counters_, &events_[2]),
      publish_(settings, engine_, &outputs_, &publisher_, &monitor_, &counters_, &events_[3]) {
  if (injection != nullptr) {
    injection->SetEventLogs({&events_[0], &events_[1], &events_[2], &events_[3]});
    collect_.SetInjection(injection);
    publish_.SetInjection(injection);
  }
  if (!plant.record_packs) return;
  record_ = std::make_unique<RecordRing>();
  collect_.SetRecord(record_.get());
}

bool Lane::TakeEvent(Event* event) noexcept {
  return std::any_of(events_.begin(), events_.end(), [event](EventLog& log) { return log.Take(event); });
}

std::int64_t Lane::events_dropped() const noexcept {
  std::int64_t sum = 0;
  for (const EventLog& log : events_) sum += log.dropped();
  return sum;
}

}  // namespace armcmc::rt
