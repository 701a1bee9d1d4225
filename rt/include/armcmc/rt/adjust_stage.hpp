#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/counters.hpp"
#include "armcmc/rt/cpu_time_meter.hpp"
#include "armcmc/rt/deadline_monitor.hpp"
#include "armcmc/rt/event_log.hpp"
#include "armcmc/rt/hand_over.hpp"
#include "armcmc/rt/settings.hpp"
#include "armcmc/rt/step_engine.hpp"

namespace armcmc::rt {

/// Minimum of the last 8 durations of a stage, ns: its duration without disturbances. O(1) to add, O(8) to read; one
/// thread.
class RecentMinimum {
 public:
  /// Adds a duration; the oldest one is dropped.
  void Add(Nanos duration_ns) noexcept ARMCMC_NONBLOCKING { recent_ns_[next_++ % kWindow] = duration_ns; }
  /// The minimum; 0 before the first duration.
  [[nodiscard]] Nanos Get() const noexcept ARMCMC_NONBLOCKING {
    const std::size_t n = std::min(next_, kWindow);
    return n == 0 ? 0 : *std::min_element(recent_ns_.begin(), recent_ns_.begin() + static_cast<std::ptrdiff_t>(n));
  }

 private:
  static constexpr std::size_t kWindow = 8;
  std::array<Nanos, kWindow> recent_ns_{};
  std::size_t next_ = 0;
};

/// Absolute time at which adjust has to stop:
///
///   min(start + budget, deadline - reserve),
///
/// or start + budget if start is already beyond deadline - reserve. Such a pack has missed its deadline; it gets the
/// whole budget, because the next estimate needs what it teaches.
/// @param start_ns     Start of adjust, CLOCK_MONOTONIC.
/// @param deadline_ns  Deadline of the step, CLOCK_MONOTONIC.
/// @param budget_ns    [timing] adjust_budget_ms.
/// @param reserve_ns   Time that execute needs.
[[nodiscard]] constexpr Nanos AdjustDeadline(Nanos start_ns, Nanos deadline_ns, Nanos budget_ns,
                                             Nanos reserve_ns) noexcept {
  const Nanos latest = deadline_ns - reserve_ns;
  return start_ns >= latest ? start_ns + budget_ns : std::min(start_ns + budget_ns, latest);
}

/// Deadline of one of several plants that wait for the same thread: start + (deadline - start) / waiting.
/// @param start_ns     Start of adjust, CLOCK_MONOTONIC.
/// @param deadline_ns  Time until which all of them are to be done.
/// @param waiting      Plants that wait, this one included; values below 1 count as 1.
[[nodiscard]] constexpr Nanos FairDeadline(Nanos start_ns, Nanos deadline_ns, int waiting) noexcept {
  return start_ns + (deadline_ns - start_ns) / std::max(waiting, 1);
}

/// Second stage: draws from the new posterior, directly into the result slot that is handed to execute.
class AdjustStage {
 public:
  /// Set-up thread; all arguments except the settings must outlive the stage.
  /// @param settings  Deadline, budget and reserve.
  /// @param engine    Runs Adjust() and Remember().
  /// @param ring      Packs from collect. @param results  Slots for execute.
  /// @param monitor   Notified of packs that are dropped.
  /// @param counters, events  Written by this stage only in its own group.
  AdjustStage(const RtSettings& settings, StepEngine* engine, PackRing* ring, ResultHandOver* results,
              DeadlineMonitor* monitor, Counters* counters, EventLog* events) noexcept;

  /// Takes the next pack worth computing from the ring and adjusts to it.
  ///
  /// Packs are taken in order while their deadline can be kept. One that cannot keep it is dropped when a newer
  /// one waits; the newest is always computed. A result that execute has not taken is not overtaken before its
  /// deadline.
  /// @param waiting  Plants whose packs wait, this one among them: they share the time that is left.
  /// @return true when a result was handed over; false when the ring is empty or execute has to come first.
  /// @rt No heap, no lock, no throw, no system call but those of the CPU time meter. Bounded by the adjust budget plus
  /// the ring's capacity.
  [[nodiscard]] bool Step(int waiting = 1) noexcept ARMCMC_NONBLOCKING;
  /// The part of a step that only the next pack needs. After a Step() that handed over a result, and after the thread
  /// of execute was woken.
  /// @rt As Step(), bounded by the draws.
  void Remember() noexcept ARMCMC_NONBLOCKING;

  /// Processor time of the stage; the pipeline reports each wake-up of the thread to it.
  [[nodiscard]] CpuTimeMeter* cpu_time() noexcept { return &cpu_time_; }

 private:
  /// Drops the oldest packs while they cannot keep their deadline and a newer one waits.
  void DropTooLate() noexcept ARMCMC_NONBLOCKING;
  /// Counts a dropped pack, and records by how much it would have been late.
  void CountDropped(std::int64_t seq, MissCause cause, Nanos now_ns, Nanos lacked_ns) noexcept ARMCMC_NONBLOCKING;
  /// Counts a truncated or failed computation and raises its fault.
  void NoteStatus(const StepInfo& info) noexcept ARMCMC_NONBLOCKING;

  Nanos budget_ns_, reserve_ns_;
  StepEngine* engine_;
  PackRing* ring_;
  ResultHandOver* results_;
  DeadlineMonitor* monitor_;
  Counters* counters_;
  EventLog* events_;
  RecentMinimum typical_;  // ns that a step needs, without what the machine withheld
  CpuTimeMeter cpu_time_;
  StepTimes handed_over_;  // of the newest result
};

}  // namespace armcmc::rt
