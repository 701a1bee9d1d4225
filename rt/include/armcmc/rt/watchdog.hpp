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

/// The threads that are watched.
enum class Watched : std::uint8_t { kCollect = 0, kAdjust = 1, kExecute = 2, kPublish = 3 };
inline constexpr std::size_t kNumWatched = 4;
[[nodiscard]] std::string_view ToString(Watched watched) noexcept;

/// Detects a thread that hangs, at most one period after its next report was due.
///
/// Before it waits and before it works, every watched thread announces when it will report next. A report that is
/// overdue at two consecutive checks, the second of them on time, is a hang. A process that was suspended as a whole,
/// or a machine that stalled, delays the checks as well and is therefore not a hang.
class Watchdog {
 public:
  static constexpr Nanos kShortestSlack = 5'000'000;  ///< What a machine takes now and then to wake a thread.

  Watchdog(const RtSettings& settings, EventLog* events) noexcept;
  ~Watchdog() { Stop(); }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  /// The calling thread will be heard of again after at most so long; the slack comes on top. @rt Wait-free.
  void Promise(Watched watched, Nanos now_ns, Nanos at_most_ns) noexcept ARMCMC_NONBLOCKING {
    due_[static_cast<std::size_t>(watched)].store(now_ns + at_most_ns + slack_ns_, std::memory_order_relaxed);
  }
  /// The thread ends: nothing more is expected of it.
  void Dismiss(Watched watched) noexcept ARMCMC_NONBLOCKING {
    due_[static_cast<std::size_t>(watched)].store(0, std::memory_order_relaxed);
  }

  /// One check at now_ns that was due at due_ns. By one thread. @rt Wait-free.
  void Check(Nanos due_ns, Nanos now_ns) noexcept ARMCMC_NONBLOCKING;

  /// Starts the thread that checks, above every stage, on the CPU of collect.
  /// @throws PrivilegeError in kEnforce.
  const ThreadPlacement& Start();
  void Stop() noexcept;

  /// Threads that hang now, a bit for each of Watched. Any time.
  [[nodiscard]] std::uint32_t hung() const noexcept { return hung_.load(std::memory_order_acquire); }
  /// Hangs seen so far.
  [[nodiscard]] std::int64_t hangs() const noexcept { return hangs_.load(std::memory_order_relaxed); }
  /// FAULT_STAGE_HUNG when a thread hung since the last call. @rt Wait-free.
  [[nodiscard]] bool TakeHung() noexcept { return unread_.exchange(false, std::memory_order_acq_rel) || hung() != 0; }
  [[nodiscard]] Nanos check_period_ns() const noexcept { return check_period_ns_; }
  [[nodiscard]] Nanos slack_ns() const noexcept { return slack_ns_; }
  [[nodiscard]] int cpu() const noexcept { return request_.cpu; }
  [[nodiscard]] const RtThread& thread() const noexcept { return thread_; }

 private:
  void Run() noexcept;

  Nanos slack_ns_, check_period_ns_;
  ThreadRequest request_;
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
