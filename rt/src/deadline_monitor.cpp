#include "armcmc/rt/deadline_monitor.hpp"

#include <algorithm>

#include "armcmc/estimator_status_t.hpp"

namespace armcmc::rt {

static_assert(static_cast<int>(MissCause::kNone) == estimator_status_t::MISS_NONE);
static_assert(static_cast<int>(MissCause::kOwn) == estimator_status_t::MISS_OWN);
static_assert(static_cast<int>(MissCause::kMachine) == estimator_status_t::MISS_MACHINE);
static_assert(static_cast<int>(MissCause::kLateData) == estimator_status_t::MISS_LATE_DATA);

std::string_view ToString(MissCause cause) noexcept {
  switch (cause) {
    case MissCause::kNone: return "none";
    case MissCause::kOwn: return "own";
    case MissCause::kMachine: return "machine";
    case MissCause::kLateData: return "late data";
  }
  return "unknown";
}

DeadlineMonitor::DeadlineMonitor(const RtSettings& settings) noexcept
    : budget_ns_{settings.ExecuteReserveNs(), settings.adjust_budget_ns, settings.ExecuteReserveNs()} {}

Nanos DeadlineMonitor::StalledTime(Stage stage, Nanos begin_ns, Nanos end_ns) const noexcept {
  const WakeUpRing* witness = witness_[IndexOf(stage)];
  return witness != nullptr && begin_ns < end_ns ? witness->StalledTime(begin_ns, end_ns, end_ns) : 0;
}

Nanos DeadlineMonitor::HandOverStall(Stage stage, Nanos ready_ns, Nanos start_ns) const noexcept {
  const Stage giver = stage == Stage::kExecute ? Stage::kAdjust : Stage::kCollect;
  return std::max(StalledTime(stage, ready_ns, start_ns), StalledTime(giver, ready_ns, start_ns));
}

StageWork DeadlineMonitor::NoWork(Stage stage, Nanos ready_ns, Nanos start_ns, Nanos withheld_ns) const noexcept {
  const Nanos begin_ns = timeline_[IndexOf(stage)].EarliestStart(ready_ns);
  const bool slept = begin_ns == ready_ns;
  const Nanos seen_ns = slept ? HandOverStall(stage, begin_ns, start_ns) : StalledTime(stage, begin_ns, start_ns);
  // Two views of the same time, neither of which sees too much.
  return {ready_ns, start_ns, start_ns, std::max(seen_ns, std::min(withheld_ns, start_ns - begin_ns)), 0};
}

StageWork DeadlineMonitor::Work(Stage stage, Nanos ready_ns, const StepTimes& times) const noexcept {
  const Nanos start_ns = times.start_ns[IndexOf(stage)];
  StageWork work = NoWork(stage, ready_ns, start_ns, times.withheld_before_ns[IndexOf(stage)]);
  work.end_ns = times.end_ns[IndexOf(stage)];
  work.stall_ns = std::max(StalledTime(stage, start_ns, work.end_ns), times.withheld_ns[IndexOf(stage)]);
  return work;
}

Earlier DeadlineMonitor::Collected(const StepTimes& times) noexcept {
  return timeline_[IndexOf(Stage::kCollect)].Do(Work(Stage::kCollect, times.arrival_ns, times),
                                                {times.lateness_ns, 0, times.lateness_ns});
}

void DeadlineMonitor::RecordAdjusted(StepTimes* times) noexcept ARMCMC_NONBLOCKING {
  const StageWork work = Work(Stage::kAdjust, times->Ready(Stage::kAdjust), *times);
  times->adjusted_earlier = timeline_[IndexOf(Stage::kAdjust)].Do(work, Collected(*times));
}

void DeadlineMonitor::RecordRemembered(const StepTimes& times, Nanos end_ns,
                                       Nanos withheld_ns) noexcept ARMCMC_NONBLOCKING {
  const Nanos begin_ns = times.end_ns[IndexOf(Stage::kAdjust)];
  timeline_[IndexOf(Stage::kAdjust)].Continue(end_ns,
                                              std::max(StalledTime(Stage::kAdjust, begin_ns, end_ns), withheld_ns));
}

MissCause DeadlineMonitor::Record(const StepTimes& times) noexcept ARMCMC_NONBLOCKING {
  for (const Stage stage : {Stage::kCollect, Stage::kAdjust, Stage::kExecute}) {
    const Nanos duration = times.Duration(stage);
    stage_times_[IndexOf(stage)].Add(duration);
    waiting_times_[IndexOf(stage)].Add(times.start_ns[IndexOf(stage)] - times.Ready(stage));
    if (duration > budget_ns_[IndexOf(stage)]) overruns_[IndexOf(stage)].Add();
  }
  end_to_end_.Add(times.EndToEnd());
  const StageWork work = Work(Stage::kExecute, times.Ready(Stage::kExecute), times);
  const MissCause cause =
      Attribute(-times.Slack(), timeline_[IndexOf(Stage::kExecute)].Do(work, times.adjusted_earlier));
  if (cause != MissCause::kNone) finished_late_[static_cast<std::size_t>(cause)].Add();
  return cause;
}

MissCause DeadlineMonitor::RecordDropped(const StepTimes& times, Nanos now_ns, Nanos typical_ns,
                                         Nanos withheld_ns) noexcept ARMCMC_NONBLOCKING {
  const StageWork work = NoWork(Stage::kAdjust, times.end_ns[IndexOf(Stage::kCollect)], now_ns, withheld_ns);
  const Earlier earlier = timeline_[IndexOf(Stage::kAdjust)].GiveUp(work, Collected(times), typical_ns);
  const MissCause cause = Attribute(std::max<Nanos>(1, now_ns + typical_ns - times.deadline_ns), earlier);
  given_up_[static_cast<std::size_t>(cause)].Add();
  return cause;
}

MissCause DeadlineMonitor::RecordOvertaken(const StepTimes& times, Nanos now_ns,
                                           Nanos lacked_ns) noexcept ARMCMC_NONBLOCKING {
  const Nanos stall = HandOverStall(Stage::kExecute, times.end_ns[IndexOf(Stage::kAdjust)], now_ns);
  const Earlier& ready = times.adjusted_earlier;
  const MissCause cause = Attribute(std::max<Nanos>(1, lacked_ns),
                                    {ready.without_lateness, ready.without_stalls + stall, ready.without_both + stall});
  given_up_[static_cast<std::size_t>(cause)].Add();
  return cause;
}

std::int64_t DeadlineMonitor::misses(MissCause cause) const noexcept {
  const std::size_t i = static_cast<std::size_t>(cause);
  return finished_late_[i].Get() + given_up_[i].Get();
}

}  // namespace armcmc::rt
