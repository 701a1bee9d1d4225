#include "armcmc/rt/witness.hpp"

#include <algorithm>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/release_grid.hpp"

namespace armcmc::rt {

void WakeUpRing::Record(Nanos due_ns, Nanos woke_ns, Nanos next_due_ns) noexcept ARMCMC_NONBLOCKING {
  const std::uint64_t head = head_.load(std::memory_order_relaxed);
  Entry& entry = entries_[head % kSize];
  entry.due_ns.store(due_ns, std::memory_order_relaxed);
  entry.woke_ns.store(woke_ns, std::memory_order_relaxed);
  next_due_ns_.store(next_due_ns, std::memory_order_relaxed);
  head_.store(head + 1, std::memory_order_release);
}

Nanos WakeUpRing::StalledTime(Nanos begin_ns, Nanos end_ns, Nanos now_ns) const noexcept ARMCMC_NONBLOCKING {
  const auto inside = [&](Nanos due, Nanos woke) {
    if (woke - due <= kOrdinaryDelayNs) return Nanos{0};
    return std::max<Nanos>(0, std::min(woke, end_ns) - std::max(due, begin_ns));
  };
  const std::uint64_t head = head_.load(std::memory_order_acquire);
  const Nanos next_due = next_due_ns_.load(std::memory_order_relaxed);
  Nanos stalled = next_due > 0 && now_ns > next_due ? inside(next_due, now_ns) : 0;
  // Half of the ring only: the writer may overwrite the oldest entries during the search, never the newest half.
  const std::uint64_t reach = std::min<std::uint64_t>(head, kSize / 2);
  for (std::uint64_t i = 1; i <= reach; ++i) {
    const Entry& entry = entries_[(head - i) % kSize];
    const Nanos woke = entry.woke_ns.load(std::memory_order_relaxed);
    if (woke < begin_ns) break;
    stalled += inside(entry.due_ns.load(std::memory_order_relaxed), woke);
  }
  return stalled;
}

void Witness::Start(int priority, RtMode mode) {
  stop_.store(false);
  thread_.Start(
      {"witness", priority, cpu_, 1U << 20U}, mode, [](void* self) noexcept { static_cast<Witness*>(self)->Run(); },
      this);
}

void Witness::Stop() noexcept {
  stop_.store(true);
  thread_.Join();
}

void Witness::Run() noexcept {
  Nanos due_ns = MonotonicNow() + period_ns_;
  while (!stop_.load(std::memory_order_relaxed)) {
    SleepUntil(due_ns);
    const Nanos woke_ns = MonotonicNow();
    const Nanos delay_ns = std::max<Nanos>(0, woke_ns - due_ns);
    const Release next = NextRelease(due_ns, woke_ns, period_ns_);
    wake_ups_.Record(due_ns, woke_ns, next.time_ns);
    delays_.Add(delay_ns);
    Nanos worst = worst_ns_.load(std::memory_order_relaxed);
    // Bounded: the only other writer sets it to zero, at most once per status message.
    for (int i = 0; i < 4 && worst < delay_ns; ++i) {
      if (worst_ns_.compare_exchange_weak(worst, delay_ns, std::memory_order_relaxed)) break;
    }
    due_ns = next.time_ns;
    thread_.NoteCpuTime(RtThread::kShortTurnNs);
  }
}

}  // namespace armcmc::rt
