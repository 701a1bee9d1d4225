#include "armcmc/plant_sim/publisher.hpp"

#include <pthread.h>

#include <algorithm>
#include <cmath>
#include <csignal>

#include "armcmc/plant_sim/monotonic_clock.hpp"

namespace armcmc::plant_sim {

bool Publisher::Tee::Send(const char* channel, const void* data, int size, std::int64_t utime) noexcept {
  const bool sent = bus_->Send(channel, data, size, utime);
  if (log_ != nullptr) static_cast<void>(log_->Send(channel, data, size, utime));
  return sent;
}

Publisher::Publisher(const Scenario& scenario, std::uint64_t seed, std::int64_t run_id, const std::string& prefix,
                     const FaultPlan& faults, MessageSink* bus, LogRing* log)
    : span_ns_(std::llround(scenario.pack_span_s() * 1e9)),
      period_ns_(std::llround(scenario.pack_period_s() * 1e9)),
      num_packs_(scenario.num_packs()),
      faults_(faults),
      builder_(scenario, seed, run_id),
      tee_(bus, log),
      sender_(prefix, faults, &tee_) {}

Publisher::~Publisher() {
  RequestStop();
  Join();
}

void Publisher::Start(std::int64_t start_ns) {
  // Signals are for the main thread: none may cut this thread's sleeps short.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this, start_ns] { Run(start_ns); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

void Publisher::Join() {
  if (thread_.joinable()) thread_.join();
}

bool Publisher::WaitUntil(std::int64_t t_ns) const noexcept {
  for (;;) {
    if (stop_.load(std::memory_order_relaxed)) return false;
    const std::int64_t now = MonotonicNow();
    if (now >= t_ns) return true;
    SleepUntil(std::min(t_ns, now + kLongestNap));
  }
}

void Publisher::Run(std::int64_t start_ns) noexcept {
  WakeOnTime();
  const std::int64_t late_limit_ns = std::max<std::int64_t>(period_ns_ / 10, 1'000'000);
  std::int64_t free_ns = 0;  // End of the last wanted delay: what it holds up is not the plant's own lateness.
  for (std::int64_t k = 1; k <= num_packs_; ++k) {
    if (!builder_.Next()) {
      diverged_ = true;
      break;
    }
    const std::int64_t due_ns = start_ns + span_ns_ + (k - 1) * period_ns_;
    const std::int64_t wanted_ns = std::max(free_ns, due_ns + static_cast<std::int64_t>(faults_.LateMs(k) * 1e6));
    if (!WaitUntil(wanted_ns)) break;
    free_ns = wanted_ns;
    builder_.Stamp(due_ns, WallClockMicros());
    sender_.Send(builder_.pack(), builder_.truth());
    const std::int64_t late_ns = MonotonicNow() - wanted_ns;
    lateness_.Add(late_ns);
    if (late_ns > late_limit_ns) ++late_packs_;
    sent_.store(k, std::memory_order_release);
  }
  sender_.Flush();
  finished_.store(true, std::memory_order_release);
}

}  // namespace armcmc::plant_sim
