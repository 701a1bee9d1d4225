#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/event_log.hpp"
#include "armcmc/rt/rt_thread.hpp"
#include "armcmc/rt/settings.hpp"

namespace armcmc::rt {

/// The watched threads: the stages and the publisher.
enum class Watched : std::uint8_t { kCollect = 0, kAdjust = 1, kExecute = 2, kPublish = 3 };
inline constexpr std::size_t kNumWatched = 4;
/// Name of a watched thread for events and reports, "adjust".
[[nodiscard]] std::string_view ToString(Watched watched) noexcept;

/// Detects a thread that hangs, at most one period after its next report was due.
///
/// Before it waits and before it works, every watched thread announces when it will report next. A report that is
/// overdue at two consecutive checks, the second of which is on time, is a hang: an event, and FAULT_STAGE_HUNG in the
/// next status. If the whole process was suspended, or the machine stalled, the check itself is late, and this does not
/// count. What the process does about a hang is decided by its owner, see [rt.watchdog] on_hang.
///
/// With T_s the period of the packs, a report may be late by max(T_s / 4, 5 ms), and a check comes every
/// max(T_s / 8, 1 ms).
class Watchdog {
 public:
  /// Smallest tolerance of a report, ns: the time that a machine occasionally takes to wake a thread.
  static constexpr Nanos kShortestSlack = 5'000'000;

  /// @param settings  Period, priorities and CPUs.
  /// @param events    Receives a line for each hang; must outlive this.
  Watchdog(const RtSettings& settings, EventLog* events) noexcept;
  ~Watchdog() { Stop(); }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  /// The calling thread will report again within at_most_ns from now_ns; the slack is added.
  /// @param watched     Which thread calls.
  /// @param now_ns      CLOCK_MONOTONIC.
  /// @param at_most_ns  Duration.
  /// @rt Wait-free.
  void Announce(Watched watched, Nanos now_ns, Nanos at_most_ns) noexcept ARMCMC_NONBLOCKING {
    due_[static_cast<std::size_t>(watched)].store(now_ns + at_most_ns + slack_ns_, std::memory_order_relaxed);
  }
  /// The calling thread ends, or pauses: no further report is expected. @rt Wait-free.
  void Dismiss(Watched watched) noexcept ARMCMC_NONBLOCKING {
    due_[static_cast<std::size_t>(watched)].store(0, std::memory_order_relaxed);
  }

  /// One check. Called by the watchdog thread; public for tests with a fake clock.
  /// @param due_ns, now_ns  When the check was due, and when it runs; CLOCK_MONOTONIC.
  /// @rt Wait-free.
  void Check(Nanos due_ns, Nanos now_ns) noexcept ARMCMC_NONBLOCKING;

  /// Starts the thread that checks, with a priority above every stage, on the CPU of collect.
  /// @throws PrivilegeError  in kEnforce without the privileges.
  const ThreadPlacement& Start();
  /// Ends the thread; waits for it, for one check period at most. Without a thread, nothing.
  void Stop() noexcept;

  /// Threads that hang now: bit i is Watched i. Any time, from any thread.
  [[nodiscard]] std::uint32_t hung() const noexcept { return hung_.load(std::memory_order_acquire); }
  /// Number of hangs since the start. Any time.
  [[nodiscard]] std::int64_t hangs() const noexcept { return hangs_.load(std::memory_order_relaxed); }
  /// Whether a thread hangs, or has since the last call: FAULT_STAGE_HUNG. @rt Wait-free.
  [[nodiscard]] bool TakeHung() noexcept { return unread_.exchange(false, std::memory_order_acq_rel) || hung() != 0; }
  /// Time between checks, ns.
  [[nodiscard]] Nanos check_period_ns() const noexcept { return check_period_ns_; }
  /// Tolerance of a report, ns.
  [[nodiscard]] Nanos slack_ns() const noexcept { return slack_ns_; }
  /// CPU of the watchdog thread.
  [[nodiscard]] int cpu() const noexcept { return request_.cpu; }
  /// The watchdog thread, for its placement and its processor time.
  [[nodiscard]] const RtThread& thread() const noexcept { return thread_; }

 private:
  void Run() noexcept;

  Nanos slack_ns_, check_period_ns_;  ///< From the period of the packs.
  ThreadRequest request_;             ///< Priority and CPU of the watchdog thread.
  RtMode mode_;
  EventLog* events_;
  std::array<std::atomic<Nanos>, kNumWatched> due_{};  // 0: not watched
  std::uint32_t suspects_ = 0;                         // overdue at the last check
  Nanos grace_until_ns_ = 0;                           // after a late check: time for all to be heard of again
  std::atomic<std::uint32_t> hung_{0};
  std::atomic<std::int64_t> hangs_{0};
  std::atomic<bool> unread_{false};
  std::atomic<bool> stop_{false};
  RtThread thread_;
};

}  // namespace armcmc::rt
