#include "armcmc/rt/watchdog.hpp"

#include <algorithm>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/release_grid.hpp"

namespace armcmc::rt {
namespace {

constexpr Nanos kShortestCheckPeriod = 1'000'000;

}  // namespace

std::string_view ToString(Watched watched) noexcept {
  switch (watched) {
    case Watched::kCollect: return "collect";
    case Watched::kAdjust: return "adjust";
    case Watched::kExecute: return "execute";
    case Watched::kPublish: return "publish";
  }
  return "unknown";
}

Watchdog::Watchdog(const RtSettings& settings, EventLog* events) noexcept
    : slack_ns_(std::max(settings.period_ns / 4, kShortestSlack)),
      check_period_ns_(std::max(settings.period_ns / 8, kShortestCheckPeriod)),
      mode_(settings.mode),
      events_(events) {
  request_.name = "watchdog";
  request_.priority = settings.witness_priority;
  request_.cpu = settings.collect.cpu;
  request_.stack_bytes = 1U << 20U;
}

void Watchdog::Check(Nanos due_ns, Nanos now_ns) noexcept ARMCMC_NONBLOCKING {
  const bool on_time = now_ns - due_ns <= check_period_ns_;
  if (!on_time) grace_until_ns_ = now_ns + slack_ns_;
  std::uint32_t overdue = 0;
  for (std::size_t i = 0; i < kNumWatched; ++i) {
    const Nanos promise = due_[i].load(std::memory_order_relaxed);
    if (promise != 0 && now_ns > std::max(promise, grace_until_ns_)) overdue |= 1U << i;
  }
  const std::uint32_t before = hung_.load(std::memory_order_relaxed);
  // One that hangs stays so until it is heard of; one more is found only by a check on time.
  const std::uint32_t found = on_time ? (overdue & suspects_ & ~before) : 0;
  suspects_ = on_time ? overdue : 0;
  hung_.store((before & overdue) | found, std::memory_order_release);
  if (found == 0) return;
  unread_.store(true, std::memory_order_release);
  for (std::uint32_t i = 0; i < kNumWatched; ++i) {
    if ((found & (1U << i)) == 0) continue;
    hangs_.store(hangs_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    events_->Add({now_ns, EventKind::kStageHung, static_cast<std::uint8_t>(i), now_ns - due_[i].load(), 0});
  }
}

const ThreadPlacement& Watchdog::Start() {
  stop_.store(false);
  return thread_.Start(
      request_, mode_, [](void* self) noexcept { static_cast<Watchdog*>(self)->Run(); }, this);
}

void Watchdog::Stop() noexcept {
  stop_.store(true);
  thread_.Join();
}

void Watchdog::Run() noexcept {
  Nanos due_ns = MonotonicNow() + check_period_ns_;
  while (!stop_.load(std::memory_order_relaxed)) {
    SleepUntil(due_ns);
    const Nanos now_ns = MonotonicNow();
    Check(due_ns, now_ns);
    due_ns = NextRelease(due_ns, now_ns, check_period_ns_).time_ns;
    thread_.NoteCpuTime(RtThread::kShortTurnNs);
  }
}

}  // namespace armcmc::rt
