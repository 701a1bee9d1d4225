#pragma once

#include <array>
#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/counters.hpp"
#include "armcmc/rt/log_histogram.hpp"
#include "armcmc/rt/miss_cause.hpp"
#include "armcmc/rt/settings.hpp"
#include "armcmc/rt/stage_timeline.hpp"
#include "armcmc/rt/witness.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// Time stamps of one step, CLOCK_MONOTONIC.
struct StepTimes {
  Nanos release_ns = 0;   ///< Point of the release grid, or the arrival when the pack came early.
  Nanos lateness_ns = 0;  ///< Arrival minus grid point, >= 0; of the grid that was left while a new phase is unsettled.
  Nanos arrival_ns = 0;   ///< Kernel receive time of the pack.
  Nanos deadline_ns = 0;  ///< Absolute: release + deadline of the settings.
  std::array<Nanos, kNumStages> start_ns{}, end_ns{};
  /// CPU time withheld while there was work, ns: before start_ns, and from there to end_ns. See CpuTimeMeter. 0: none,
  /// or unknown.
  std::array<Nanos, kNumStages> withheld_before_ns{}, withheld_ns{};
  Earlier adjusted_earlier;  ///< How much earlier adjust would have finished.

  /// Time between begin and end of a stage, ns, stalls included.
  [[nodiscard]] Nanos Duration(Stage stage) const noexcept { return end_ns[IndexOf(stage)] - start_ns[IndexOf(stage)]; }
  /// When a stage could have begun: arrival of the pack, then the end of the stage before, ns.
  [[nodiscard]] Nanos Ready(Stage stage) const noexcept {
    return stage == Stage::kCollect ? arrival_ns : end_ns[IndexOf(stage) - 1];
  }
  /// Release to complete estimate, ns.
  [[nodiscard]] Nanos EndToEnd() const noexcept { return end_ns[IndexOf(Stage::kExecute)] - release_ns; }
  /// Time left until the deadline when the estimate was complete, ns; negative: missed.
  [[nodiscard]] Nanos Slack() const noexcept { return deadline_ns - end_ns[IndexOf(Stage::kExecute)]; }
};

/// Judges every step against its deadline and keeps the times of all stages.
///
/// The adjust thread calls RecordAdjusted(), RecordDropped() and RecordOvertaken(), the execute thread Record(); the
/// miss counters may be read any time, the histograms after both have ended.
class DeadlineMonitor {
 public:
  /// @param settings  Budgets of the stages; not kept.
  explicit DeadlineMonitor(const RtSettings& settings) noexcept;

  /// Wake-ups of the witness on the CPU of a stage; without one no miss is attributed to the machine.
  void SetWitness(Stage stage, const WakeUpRing* wake_ups) noexcept { witness_[IndexOf(stage)] = wake_ups; }

  /// Notes in times->adjusted_earlier what stalls and late packs cost a step that adjust has just finished, earlier
  /// steps included. @rt O(wake-ups in the step).
  void RecordAdjusted(StepTimes* times) noexcept ARMCMC_NONBLOCKING;

  /// Records the work of adjust after the hand-over of its result.
  /// @param times        Of the step that it belongs to.
  /// @param end_ns       End of that work.
  /// @param withheld_ns  Of its CPU, since the hand-over. @rt O(wake-ups in between).
  void RecordRemembered(const StepTimes& times, Nanos end_ns, Nanos withheld_ns) noexcept ARMCMC_NONBLOCKING;

  /// Judges a step that went through all stages. @rt O(wake-ups in execute).
  MissCause Record(const StepTimes& times) noexcept ARMCMC_NONBLOCKING;

  /// Judges a pack that adjust gives up in favour of a newer one: always a miss.
  /// @param times        Of the pack until then.
  /// @param now_ns       When it is given up.
  /// @param typical_ns   What adjust would have taken; now_ns + typical_ns is past the deadline.
  /// @param withheld_ns  Of the CPU of adjust, while it waited. @rt O(wake-ups since its arrival).
  MissCause RecordDropped(const StepTimes& times, Nanos now_ns, Nanos typical_ns,
                          Nanos withheld_ns = 0) noexcept ARMCMC_NONBLOCKING;

  /// Judges a result that execute did not process before the next one: always a miss.
  /// @param times      Of the step until then.
  /// @param now_ns     When it is given up.
  /// @param lacked_ns  By how much execute was late; at least 1 is assumed. @rt O(wake-ups since adjust).
  MissCause RecordOvertaken(const StepTimes& times, Nanos now_ns, Nanos lacked_ns) noexcept ARMCMC_NONBLOCKING;

  /// Missed deadlines with that cause: steps that finished late, packs given up and results overtaken. Any thread.
  [[nodiscard]] std::int64_t misses(MissCause cause) const noexcept ARMCMC_NONBLOCKING;
  /// Steps in which a stage took more than its budget (adjust: its budget; the others: the execute reserve).
  [[nodiscard]] std::int64_t stage_overruns(Stage stage) const noexcept { return overruns_[IndexOf(stage)].Get(); }
  /// Durations of a stage, ns. @pre the threads have ended, as for end_to_end().
  [[nodiscard]] const LogHistogram& stage_times(Stage stage) const noexcept { return stage_times_[IndexOf(stage)]; }
  /// Times from when a stage could have begun (StepTimes::Ready) until it did, ns: waking it, and whatever it did
  /// before. @pre the threads have ended.
  [[nodiscard]] const LogHistogram& waiting_times(Stage stage) const noexcept { return waiting_times_[IndexOf(stage)]; }
  [[nodiscard]] const LogHistogram& end_to_end() const noexcept { return end_to_end_; }

 private:
  [[nodiscard]] Nanos StalledTime(Stage stage, Nanos begin_ns, Nanos end_ns) const noexcept ARMCMC_NONBLOCKING;
  /// Stall of a stage that sleeps until the one before it hands over: that one wakes it, so a stall of either CPU
  /// counts.
  [[nodiscard]] Nanos HandOverStall(Stage stage, Nanos ready_ns, Nanos start_ns) const noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] Earlier Collected(const StepTimes& times) noexcept ARMCMC_NONBLOCKING;
  /// Of a step that went through a stage.
  [[nodiscard]] StageWork Work(Stage stage, Nanos ready_ns, const StepTimes& times) const noexcept ARMCMC_NONBLOCKING;
  /// Of a step that a stage reached at start_ns and did not process.
  [[nodiscard]] StageWork NoWork(Stage stage, Nanos ready_ns, Nanos start_ns,
                                 Nanos withheld_ns) const noexcept ARMCMC_NONBLOCKING;

  std::array<const WakeUpRing*, kNumStages> witness_{};
  std::array<StageTimeline, kNumStages> timeline_;  // collect, adjust: of the adjust thread; execute: of its own
  std::array<Nanos, kNumStages> budget_ns_;
  std::array<LogHistogram, kNumStages> stage_times_, waiting_times_;
  LogHistogram end_to_end_;
  std::array<Counter, kNumStages> overruns_;
  std::array<Counter, kNumMissCauses> finished_late_;  // written by the execute thread
  std::array<Counter, kNumMissCauses> given_up_;       // written by the adjust thread
};

}  // namespace armcmc::rt
