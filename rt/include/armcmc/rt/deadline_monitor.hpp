#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/counters.hpp"
#include "armcmc/rt/log_histogram.hpp"
#include "armcmc/rt/settings.hpp"
#include "armcmc/rt/witness.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// Why a deadline was missed. Values equal estimator_status_t.MISS_*.
enum class MissCause : std::uint8_t { kNone = 0, kOwn = 1, kMachine = 2, kLateData = 3 };
inline constexpr std::size_t kNumMissCauses = 4;
[[nodiscard]] std::string_view ToString(MissCause cause) noexcept ARMCMC_NONBLOCKING;

/// Time stamps of one step, CLOCK_MONOTONIC.
struct StepTimes {
  Nanos release_ns = 0;   ///< Point of the release grid, or the arrival when the pack came early.
  Nanos lateness_ns = 0;  ///< Arrival minus grid point, >= 0.
  Nanos arrival_ns = 0;   ///< Kernel receive time of the pack.
  Nanos deadline_ns = 0;  ///< Absolute: release + deadline of the settings.
  std::array<Nanos, kNumStages> start_ns{}, end_ns{};

  [[nodiscard]] Nanos Duration(Stage stage) const noexcept { return end_ns[IndexOf(stage)] - start_ns[IndexOf(stage)]; }
  [[nodiscard]] Nanos EndToEnd() const noexcept { return end_ns[IndexOf(Stage::kExecute)] - release_ns; }
  [[nodiscard]] Nanos Slack() const noexcept { return deadline_ns - end_ns[IndexOf(Stage::kExecute)]; }
};

/// What is known about a step that lacked time.
struct MissEvidence {
  Nanos lacked_ns = 0;    ///< By how much the deadline was missed; <= 0: it was not.
  Nanos lateness_ns = 0;  ///< How late the pack came on the locked grid.
  Nanos stall_ns = 0;     ///< Time a witness on the CPU of the stage that was running waited in vain.
};

/// Exactly one cause per miss.
///
/// Late data, when the pack alone came late by at least what the step lacked; else the machine, when the stalls that
/// the witnesses saw alone are as long as that: without them the deadline had been met; else our own. In doubt it is
/// our own.
[[nodiscard]] constexpr MissCause Attribute(const MissEvidence& evidence) noexcept {
  if (evidence.lacked_ns <= 0) return MissCause::kNone;
  if (evidence.lateness_ns >= evidence.lacked_ns) return MissCause::kLateData;
  if (evidence.stall_ns >= evidence.lacked_ns) return MissCause::kMachine;
  return MissCause::kOwn;
}

/// Judges every step against its deadline and keeps the times of all stages.
///
/// The execute thread calls Record(), the adjust thread RecordDropped(); the miss counters may be read any time, the
/// histograms after both have ended.
class DeadlineMonitor {
 public:
  explicit DeadlineMonitor(const RtSettings& settings) noexcept;

  /// Wake-ups of the witness on the CPU of a stage; without one the machine is never blamed.
  void SetWitness(Stage stage, const WakeUpRing* wake_ups) noexcept { witness_[IndexOf(stage)] = wake_ups; }

  /// Judges a step that went through all stages. @rt O(wake-ups in the step) on a miss, else O(1).
  MissCause Record(const StepTimes& times) noexcept ARMCMC_NONBLOCKING;

  /// Judges a pack that was given up at now_ns in favour of a newer one: always a miss.
  /// @param waiting_for  Stage that it did not get through.
  /// @param lacked_ns    What its predicted end lacks against the deadline; at least 1 is assumed.
  /// @rt O(wake-ups since its arrival).
  MissCause RecordDropped(const StepTimes& times, Stage waiting_for, Nanos now_ns,
                          Nanos lacked_ns) noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] std::int64_t misses(MissCause cause) const noexcept ARMCMC_NONBLOCKING;
  /// Steps in which a stage took more than its budget (adjust: its budget; the others: the execute reserve).
  [[nodiscard]] std::int64_t stage_overruns(Stage stage) const noexcept { return overruns_[IndexOf(stage)].Get(); }
  [[nodiscard]] const LogHistogram& stage_times(Stage stage) const noexcept { return stage_times_[IndexOf(stage)]; }
  [[nodiscard]] const LogHistogram& end_to_end() const noexcept { return end_to_end_; }

 private:
  [[nodiscard]] Nanos StalledTime(const StepTimes& times, Stage last, Nanos end_ns) const noexcept ARMCMC_NONBLOCKING;

  std::array<const WakeUpRing*, kNumStages> witness_{};
  std::array<Nanos, kNumStages> budget_ns_;
  std::array<LogHistogram, kNumStages> stage_times_;
  LogHistogram end_to_end_;
  std::array<Counter, kNumStages> overruns_;
  std::array<Counter, kNumMissCauses> finished_late_;  // written by the execute thread
  std::array<Counter, kNumMissCauses> given_up_;       // written by the adjust thread
};

}  // namespace armcmc::rt
