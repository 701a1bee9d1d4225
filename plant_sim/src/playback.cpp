#include "armcmc/plant_sim/playback.hpp"

#include <algorithm>
#include <cmath>

#include "armcmc/plant_sim/monotonic_clock.hpp"

namespace armcmc::plant_sim {

PlaybackResult Play(DescribedPackBuilder* builder, DescribedPackSender* sender, std::int64_t start_ns, double speed,
                    const std::function<bool(std::int64_t)>& is_stopped) {
  const double period_ns = builder->pack_period_s() / speed * 1e9;
  const std::int64_t late_limit_ns = std::max<std::int64_t>(std::llround(period_ns / 10.0), 1'000'000);
  PlaybackResult result;
  WakeOnTime();
  while (builder->Next()) {
    const std::int64_t due_ns = start_ns + std::llround(period_ns * static_cast<double>(result.packs_sent + 1));
    do {
      if (is_stopped(result.packs_sent)) return result;
      SleepUntil(std::min(due_ns, MonotonicNow() + kLongestNap));
    } while (MonotonicNow() < due_ns);
    builder->Stamp(due_ns, WallClockMicros());
    sender->Send(builder->pack());
    ++result.packs_sent;
    if (MonotonicNow() - due_ns > late_limit_ns) ++result.packs_late;
  }
  return result;
}

}  // namespace armcmc::plant_sim
