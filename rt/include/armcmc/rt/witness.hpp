#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/log_histogram.hpp"
#include "armcmc/rt/rt_thread.hpp"
#include "armcmc/rt/spsc_ring.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// The newest wake-ups of a periodic timer thread: when each was due and when it came.
/// One writer; any number of readers at any time.
class WakeUpRing {
 public:
  static constexpr std::size_t kSize = 4096;  ///< Four seconds at 1 ms.
  /// A wake-up that comes later than this is a stall; the latency of every wake-up of a machine in health is below it.
  static constexpr Nanos kOrdinaryDelayNs = 100'000;

  /// @param due_ns       When the wake-up was due.
  /// @param woke_ns      When it came.
  /// @param next_due_ns  When the wake-up after this one is due. @rt Wait-free.
  void Record(Nanos due_ns, Nanos woke_ns, Nanos next_due_ns) noexcept ARMCMC_NONBLOCKING;

  /// Time inside [begin, end] in which the machine stood still: sum over the wake-ups that came later than
  /// kOrdinaryDelayNs of the part of [due, woke] that lies in the window.
  ///
  /// A wake-up that is overdue at `now` stalls until now. Stalls are added up, since a hypervisor that is short of time
  /// takes it in many slices of a millisecond or two; a hundred ordinary wake-up latencies are not a stall.
  /// A lower bound: what is taken between a wake-up and the next due time is not seen.
  /// @rt Wait-free, O(wake-ups since begin), at most kSize / 2, which is 2048 periods of the witness.
  [[nodiscard]] Nanos StalledTime(Nanos begin_ns, Nanos end_ns, Nanos now_ns) const noexcept ARMCMC_NONBLOCKING;

 private:
  /// One wake-up, CLOCK_MONOTONIC.
  struct Entry {
    std::atomic<Nanos> due_ns{0};
    std::atomic<Nanos> woke_ns{0};
  };
  std::array<Entry, kSize> entries_{};
  alignas(kCacheLine) std::atomic<std::uint64_t> head_{0};  // wake-ups recorded
  std::atomic<Nanos> next_due_ns_{0};                       // 0: not started
};

/// A timer thread above every stage on one CPU. It does nothing but notice when it is woken late: then it was
/// the machine that stood still (hypervisor, firmware, kernel), since no thread of ours can delay it. What is taken
/// from a stage while it works, CpuTimeMeter sees better.
class Witness {
 public:
  /// A fortieth of the deadline, within [0.25 ms, 1 ms]: shorter slices are hardly seen, and each wake-up costs the
  /// stages of its CPU some 10 us.
  [[nodiscard]] static constexpr Nanos PeriodFor(Nanos deadline_ns) noexcept {
    return std::clamp<Nanos>(deadline_ns / 40, 250'000, 1'000'000);
  }

  /// @param cpu  CPU whose stalls are measured. @param period_ns  Time between wake-ups, see PeriodFor().
  Witness(int cpu, Nanos period_ns) noexcept : cpu_(cpu), period_ns_(period_ns) {}
  ~Witness() { Stop(); }

  /// Starts the thread.
  /// @param priority  SCHED_FIFO; above every stage.
  /// @param mode      What to do without the privileges.
  /// @throws PrivilegeError  in kEnforce without the privileges.
  void Start(int priority, RtMode mode);
  /// Ends the thread; waits for it.
  void Stop() noexcept;

  /// CPU whose stalls it measures.
  [[nodiscard]] int cpu() const noexcept { return cpu_; }
  /// Time between its wake-ups, ns.
  [[nodiscard]] Nanos period_ns() const noexcept { return period_ns_; }
  /// Whether the thread runs with its priority and on its CPU. Otherwise a late wake-up is not evidence of a stall of
  /// the machine.
  [[nodiscard]] bool trustworthy() const noexcept { return thread_.placement().fifo && thread_.placement().pinned; }
  /// The newest wake-ups. Any time, from any thread.
  [[nodiscard]] const WakeUpRing& wake_ups() const noexcept { return wake_ups_; }
  /// Policy, priority and CPU, read back from the kernel.
  [[nodiscard]] const ThreadPlacement& placement() const noexcept { return thread_.placement(); }
  [[nodiscard]] const RtThread& thread() const noexcept { return thread_; }
  /// Longest delay since the last call, ns. @rt Wait-free.
  [[nodiscard]] Nanos TakeWorst() noexcept ARMCMC_NONBLOCKING {
    return worst_ns_.exchange(0, std::memory_order_relaxed);
  }
  /// Delays of all wake-ups, ns. @pre stopped.
  [[nodiscard]] const LogHistogram& delays() const noexcept { return delays_; }

 private:
  void Run() noexcept ARMCMC_NONBLOCKING;

  int cpu_;  ///< Where it runs.
  Nanos period_ns_;
  WakeUpRing wake_ups_;  ///< The newest wake-ups.
  LogHistogram delays_;  ///< ns.
  std::atomic<Nanos> worst_ns_{0};
  std::atomic<bool> stop_{false};
  RtThread thread_;  ///< Above every stage.
};

}  // namespace armcmc::rt
