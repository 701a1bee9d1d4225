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

Nanos DeadlineMonitor::StalledTime(const StepTimes& times, Stage last, Nanos end_ns) const noexcept {
  // From the arrival on, since before it there was nothing to delay. The wait for a stage counts as that stage's.
  Nanos begin = times.arrival_ns;
  Nanos stalled = 0;
  for (std::size_t i = 0; i <= IndexOf(last); ++i) {
    const Nanos end = i == IndexOf(last) ? end_ns : times.end_ns[i];
    if (witness_[i] != nullptr) stalled += witness_[i]->StalledTime(begin, end, end);
    begin = end;
  }
  return stalled;
}

MissCause DeadlineMonitor::Record(const StepTimes& times) noexcept ARMCMC_NONBLOCKING {
  for (const Stage stage : {Stage::kCollect, Stage::kAdjust, Stage::kExecute}) {
    const Nanos duration = times.Duration(stage);
    stage_times_[IndexOf(stage)].Add(duration);
    if (duration > budget_ns_[IndexOf(stage)]) overruns_[IndexOf(stage)].Add();
  }
  end_to_end_.Add(times.EndToEnd());
  if (times.Slack() >= 0) return MissCause::kNone;
  const Nanos stall = StalledTime(times, Stage::kExecute, times.end_ns[IndexOf(Stage::kExecute)]);
  const MissCause cause = Attribute({-times.Slack(), times.lateness_ns, stall});
  finished_late_[static_cast<std::size_t>(cause)].Add();
  return cause;
}

MissCause DeadlineMonitor::RecordDropped(const StepTimes& times, Stage waiting_for, Nanos now_ns,
                                         Nanos lacked_ns) noexcept ARMCMC_NONBLOCKING {
  const Nanos stall = StalledTime(times, waiting_for, now_ns);
  const MissCause cause = Attribute({std::max<Nanos>(1, lacked_ns), times.lateness_ns, stall});
  given_up_[static_cast<std::size_t>(cause)].Add();
  return cause;
}

std::int64_t DeadlineMonitor::misses(MissCause cause) const noexcept {
  const std::size_t i = static_cast<std::size_t>(cause);
  return finished_late_[i].Get() + given_up_[i].Get();
}

}  // namespace armcmc::rt
