#include <algorithm>
#include <atomic>
#include <cstdio>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/rt_thread.hpp"
#include "armcmc/rtcheck/findings.hpp"

namespace armcmc::rtcheck {
namespace {

struct Measurement {
  Nanos end_ns = 0;
  WakeUps* wake_ups = nullptr;

  static void Run(void* self) noexcept {
    auto* m = static_cast<Measurement*>(self);
    Nanos due_ns = rt::MonotonicNow() + rt::kNanosPerMilli;
    while (due_ns < m->end_ns) {
      rt::SleepUntil(due_ns);
      const Nanos now_ns = rt::MonotonicNow();
      m->wake_ups->late_ns.Add(std::max<Nanos>(0, now_ns - due_ns));
      due_ns = std::max(due_ns + rt::kNanosPerMilli, now_ns);
    }
  }
};

double Ms(double ns) { return ns * 1e-6; }

}  // namespace

WakeUps MeasureWakeUps(int cpu, double seconds) {
  WakeUps wake_ups;
  Measurement measurement;
  measurement.wake_ups = &wake_ups;
  measurement.end_ns = rt::MonotonicNow() + static_cast<Nanos>(seconds * 1e9);
  rt::RtThread thread;
  const rt::ThreadPlacement& placement =
      thread.Start({"rtcheck", 90, cpu, 1U << 20U}, rt::RtMode::kBestEffort, &Measurement::Run, &measurement);
  wake_ups.fifo = placement.fifo;
  wake_ups.pinned = placement.pinned;
  thread.Join();
  return wake_ups;
}

Finding CheckWakeUps(const WakeUps& wake_ups, const Demand& demand) {
  const double p999_ms = Ms(wake_ups.late_ns.Quantile(0.999)), max_ms = Ms(static_cast<double>(wake_ups.late_ns.max()));
  char what[160];
  std::snprintf(what, sizeof what, "woken late by %.3g ms (median), %.3g ms (99.9 %%), %.3g ms (worst of %lld)%s",
                Ms(wake_ups.late_ns.Quantile(0.5)), p999_ms, max_ms, static_cast<long long>(wake_ups.late_ns.count()),
                wake_ups.fifo ? "" : ", without SCHED_FIFO");
  Finding finding{"wake_up", Level::kOk, what, "", ""};
  if (wake_ups.late_ns.count() == 0 || max_ms >= demand.deadline_ms || p999_ms >= 0.25 * demand.deadline_ms) {
    finding.level = Level::kUnfit;
    finding.cost = max_ms >= demand.deadline_ms ? "a whole deadline is lost at once"
                                                : "a quarter of the deadline is lost once in a thousand steps";
    finding.remedy = "fix what is listed above and repeat it overnight: armcmc-rtcheck --seconds 30000";
  }
  return finding;
}

}  // namespace armcmc::rtcheck
