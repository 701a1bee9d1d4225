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
  const WakeUpRing* witness = witness_[IndexOf(stage)].wake_ups;
  return witness != nullptr && begin_ns < end_ns ? witness->StalledTime(begin_ns, end_ns, end_ns) : 0;
}

Nanos DeadlineMonitor::StallBefore(Stage stage, Nanos begin_ns, Nanos start_ns, Nanos others_ns) const noexcept {
  const auto& [witness, foremost] = witness_[IndexOf(stage)];
  const Nanos seen_ns = StalledTime(stage, begin_ns, start_ns);
  if (witness == nullptr || !foremost || others_ns == kAwake) return seen_ns;
  const Nanos delay_ns = start_ns - begin_ns - others_ns;
  return delay_ns > WakeUpRing::kOrdinaryDelayNs ? std::max(seen_ns, delay_ns) : seen_ns;
}

StageWork DeadlineMonitor::Work(Stage stage, Nanos ready_ns, Nanos start_ns, Nanos end_ns, Nanos others_ns) noexcept {
  Queue& queue = queue_[IndexOf(stage)];
  return {ready_ns, start_ns, end_ns, StallBefore(stage, queue.timeline.CouldBegin(ready_ns), start_ns, others_ns),
          queue.work.Stalled(end_ns - start_ns, StalledTime(stage, start_ns, end_ns))};
}

Earlier DeadlineMonitor::Collected(const StepTimes& times) noexcept {
  const std::size_t collect = IndexOf(Stage::kCollect);
  const StageWork work = Work(Stage::kCollect, times.arrival_ns, times.start_ns[collect], times.end_ns[collect], 0);
  return queue_[collect].timeline.Do(work, {times.lateness_ns, 0, times.lateness_ns});
}

void DeadlineMonitor::RecordAdjusted(StepTimes* times, bool held) noexcept ARMCMC_NONBLOCKING {
  const std::size_t adjust = IndexOf(Stage::kAdjust);
  const StageWork work = Work(Stage::kAdjust, times->end_ns[IndexOf(Stage::kCollect)], times->start_ns[adjust],
                              times->end_ns[adjust], held ? kAwake : 0);
  times->collect_worked_ns = collect_worked_.Get();
  times->adjusted_earlier = queue_[adjust].timeline.Do(work, Collected(*times));
}

MissCause DeadlineMonitor::Record(const StepTimes& times) noexcept ARMCMC_NONBLOCKING {
  for (const Stage stage : {Stage::kCollect, Stage::kAdjust, Stage::kExecute}) {
    const Nanos duration = times.Duration(stage);
    stage_times_[IndexOf(stage)].Add(duration);
    if (duration > budget_ns_[IndexOf(stage)]) overruns_[IndexOf(stage)].Add();
  }
  end_to_end_.Add(times.EndToEnd());
  const std::size_t execute = IndexOf(Stage::kExecute);
  const StageWork work = Work(Stage::kExecute, times.end_ns[IndexOf(Stage::kAdjust)], times.start_ns[execute],
                              times.end_ns[execute], collect_worked_.Get() - times.collect_worked_ns);
  const MissCause cause = Attribute(-times.Slack(), queue_[execute].timeline.Do(work, times.adjusted_earlier));
  if (cause != MissCause::kNone) finished_late_[static_cast<std::size_t>(cause)].Add();
  return cause;
}

MissCause DeadlineMonitor::RecordDropped(const StepTimes& times, Nanos now_ns, Nanos typical_ns,
                                         bool held) noexcept ARMCMC_NONBLOCKING {
  StageWork work;
  work.ready_ns = times.end_ns[IndexOf(Stage::kCollect)];
  work.start_ns = work.end_ns = now_ns;
  StageTimeline& timeline = queue_[IndexOf(Stage::kAdjust)].timeline;
  work.stall_before_ns = StallBefore(Stage::kAdjust, timeline.CouldBegin(work.ready_ns), now_ns, held ? kAwake : 0);
  const Earlier earlier = timeline.GiveUp(work, Collected(times), typical_ns);
  const MissCause cause = Attribute(std::max<Nanos>(1, now_ns + typical_ns - times.deadline_ns), earlier);
  given_up_[static_cast<std::size_t>(cause)].Add();
  return cause;
}

MissCause DeadlineMonitor::RecordOvertaken(const StepTimes& times, Nanos now_ns,
                                           Nanos lacked_ns) noexcept ARMCMC_NONBLOCKING {
  const Nanos stall = StalledTime(Stage::kExecute, times.end_ns[IndexOf(Stage::kAdjust)], now_ns);
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
