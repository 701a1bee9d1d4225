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

/// Shortest of the last durations of a stage: what it takes when nothing disturbs it.
class RecentMinimum {
 public:
  void Add(Nanos duration_ns) noexcept ARMCMC_NONBLOCKING { recent_ns_[next_++ % kWindow] = duration_ns; }
  [[nodiscard]] Nanos Get() const noexcept ARMCMC_NONBLOCKING {
    const std::size_t n = std::min(next_, kWindow);
    return n == 0 ? 0 : *std::min_element(recent_ns_.begin(), recent_ns_.begin() + static_cast<std::ptrdiff_t>(n));
  }

 private:
  static constexpr std::size_t kWindow = 8;
  std::array<Nanos, kWindow> recent_ns_{};
  std::size_t next_ = 0;
};

/// Absolute time before which adjust has to stop.
///
/// The budget counts from the start of adjust and leaves the execute reserve before the deadline. A pack for which
/// not even that is left has missed its deadline already; it gets the whole budget, since what it teaches is
/// needed for the next one.
[[nodiscard]] constexpr Nanos AdjustDeadline(Nanos start_ns, Nanos deadline_ns, Nanos budget_ns,
                                             Nanos reserve_ns) noexcept {
  const Nanos latest = deadline_ns - reserve_ns;
  return start_ns >= latest ? start_ns + budget_ns : std::min(start_ns + budget_ns, latest);
}

/// The part of the time up to a deadline that falls to one of so many plants that wait for it.
[[nodiscard]] constexpr Nanos FairDeadline(Nanos start_ns, Nanos deadline_ns, int waiting) noexcept {
  return start_ns + (deadline_ns - start_ns) / std::max(waiting, 1);
}

/// Second stage: the draws. Writes straight into the result slot that it hands over.
class AdjustStage {
 public:
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
  /// After a Step() that handed over a result, and after whoever takes it was woken: what only the next pack needs.
  /// @rt As Step(), bounded by the draws.
  void Remember() noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] CpuTimeMeter* cpu_time() noexcept { return &cpu_time_; }

 private:
  void DropUnkeepable() noexcept ARMCMC_NONBLOCKING;
  void CountDropped(std::int64_t seq, MissCause cause, Nanos now_ns, Nanos lacked_ns) noexcept ARMCMC_NONBLOCKING;
  void NoteStatus(const StepInfo& info) noexcept ARMCMC_NONBLOCKING;

  Nanos budget_ns_, reserve_ns_;
  StepEngine* engine_;
  PackRing* ring_;
  ResultHandOver* results_;
  DeadlineMonitor* monitor_;
  Counters* counters_;
  EventLog* events_;
  RecentMinimum typical_;
  CpuTimeMeter cpu_time_;
  StepTimes handed_over_;  // of the newest result
};

}  // namespace armcmc::rt
