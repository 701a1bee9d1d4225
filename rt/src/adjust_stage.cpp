#include "armcmc/rt/adjust_stage.hpp"

#include "armcmc/estimator_status_t.hpp"
#include "armcmc/rt/clock.hpp"

namespace armcmc::rt {

AdjustStage::AdjustStage(const RtSettings& settings, StepEngine* engine, PackRing* ring, ResultHandOver* results,
                         DeadlineMonitor* monitor, Counters* counters, EventLog* events) noexcept
    : budget_ns_(settings.adjust_budget_ns),
      reserve_ns_(settings.ExecuteReserveNs()),
      engine_(engine),
      ring_(ring),
      results_(results),
      monitor_(monitor),
      counters_(counters),
      events_(events) {}

void AdjustStage::CountDropped(std::int64_t seq, MissCause cause, Nanos now_ns, Nanos lacked_ns) noexcept {
  counters_->adjust.dropped.Add();
  counters_->faults.Raise(estimator_status_t::FAULT_BACKLOG);
  events_->Add({now_ns, EventKind::kPackDropped, static_cast<std::uint8_t>(cause), seq, lacked_ns});
}

void AdjustStage::DropTooLate() noexcept {
  for (std::size_t i = 1; i < PackRing::capacity() && ring_->size() > 1; ++i) {
    const PackSlot* slot = ring_->Front();
    const Nanos now_ns = MonotonicNow();
    const Nanos lacked_ns = now_ns + typical_.Get() - slot->times.deadline_ns;
    if (lacked_ns <= 0) return;
    const MissCause cause =
        monitor_->RecordDropped(slot->times, now_ns, typical_.Get(), cpu_time_.WithheldWaiting(now_ns));
    CountDropped(slot->pack.seq, cause, now_ns, lacked_ns);
    ring_->Pop();
  }
}

void AdjustStage::NoteStatus(const StepInfo& info) noexcept {
  if (info.status == Status::kTruncated) {
    counters_->adjust.truncated.Add();
    counters_->faults.Raise(estimator_status_t::FAULT_TRUNCATED);
  } else if (info.status == Status::kNonFinite || info.status == Status::kBadPack) {
    counters_->adjust.numeric.Add();
    counters_->faults.Raise(estimator_status_t::FAULT_NUMERIC);
    events_->Add({info.times.end_ns[IndexOf(Stage::kAdjust)], EventKind::kNumericTrouble,
                  static_cast<std::uint8_t>(info.status), info.seq, 0});
  }
}

void AdjustStage::Remember() noexcept {
  engine_->Remember(MonotonicClock());
  const Nanos end_ns = MonotonicNow();
  monitor_->RecordRemembered(handed_over_, end_ns, cpu_time_.Continue(end_ns));
}

bool AdjustStage::Step(int waiting) noexcept {
  DropTooLate();
  PackSlot* slot = ring_->Front();
  if (slot == nullptr) return false;
  if (results_->latest.unread() && MonotonicNow() < handed_over_.deadline_ns) return false;
  const Nanos start_ns = cpu_time_.Start();
  const int result = results_->latest.write_slot();
  StepInfo& info = results_->info[static_cast<std::size_t>(result)];
  info.seq = slot->pack.seq;
  info.run_id = slot->pack.run_id;
  info.times = slot->times;
  info.times.start_ns[IndexOf(Stage::kAdjust)] = start_ns;
  const Nanos until_ns = AdjustDeadline(start_ns, info.times.deadline_ns, budget_ns_, reserve_ns_);
  info.status = engine_->Adjust(slot->pack, FairDeadline(start_ns, until_ns, waiting), MonotonicClock(), result);
  const Nanos end_ns = MonotonicNow();
  info.times.end_ns[IndexOf(Stage::kAdjust)] = end_ns;
  info.times.withheld_before_ns[IndexOf(Stage::kAdjust)] = cpu_time_.withheld_before_ns();
  const Nanos withheld_ns = cpu_time_.End(end_ns);
  info.times.withheld_ns[IndexOf(Stage::kAdjust)] = withheld_ns;
  monitor_->RecordAdjusted(&info.times);
  ring_->Pop();
  typical_.Add(end_ns - start_ns - withheld_ns);
  NoteStatus(info);
  handed_over_ = info.times;
  if (results_->latest.Publish()) {
    // Execute did not come to the result before: it is lost, and its note is in the slot that is ours again.
    const StepInfo& lost = results_->info[static_cast<std::size_t>(results_->latest.write_slot())];
    const Nanos waited_ns = end_ns - lost.times.end_ns[IndexOf(Stage::kAdjust)];
    const Nanos lacked_ns = std::max(waited_ns, end_ns - lost.times.deadline_ns);
    CountDropped(lost.seq, monitor_->RecordOvertaken(lost.times, end_ns, lacked_ns), end_ns, lacked_ns);
  }
  return true;
}

}  // namespace armcmc::rt
