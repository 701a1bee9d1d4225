#include "armcmc/stress/fault_judge.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace armcmc::stress {
namespace {

constexpr double kApart = 2.0;  // joint standard deviations

}  // namespace

void FaultJudge::BeginRun(std::vector<Slot> slots) {
  slots_ = std::move(slots);
  next_ = 0;
  started_ = false;
  last_run_id_ = run_id_;
  steps_.clear();
  reference_ = last_step_;
  evidence_ = {};
  evidence_.before = evidence_.after = last_status_;
  has_before_ = true;
  background_ = raised_ = 0;
  unheard_ = statuses_ = 0;
  signalled_ = false;
  affected_until_ = 0;
}

void FaultJudge::OnEstimate(const estimate_t& estimate) {
  if (!started_) {
    if (any_estimate_ && estimate.run_id == last_run_id_) return;  // of the run before
    started_ = any_estimate_ = true;
    run_id_ = estimate.run_id;
  }
  if (estimate.run_id != run_id_) return;
  Step& step = steps_[estimate.seq];
  step.has_estimate = estimate.known != 0;
  step.truncated = estimate.truncated != 0;
  step.modification = estimate.decision == estimate_t::DECISION_MODIFICATION;
  for (std::size_t i = 0; i < step.value.size(); ++i) {
    step.value[i] = estimate.ar_map[i];
    step.lo[i] = estimate.q025[i];
    step.hi[i] = estimate.q975[i];
    step.sd[i] = estimate.sd[i];
  }
  last_step_ = step;
  newest_seq_ = estimate.seq;
  newest_release_ns_ = estimate.t_release_ns;
  if (const Slot* slot = current(); slot != nullptr && estimate.seq >= slot->begin && estimate.seq < slot->at()) {
    reference_ = step;
  }
}

std::int64_t FaultJudge::NotOwn(const estimator_status_t& status) const {
  const bool disturbed = status.miss_cause == estimator_status_t::MISS_MACHINE ||
                         status.miss_cause == estimator_status_t::MISS_LATE_DATA ||
                         (status.fault_flags & estimator_status_t::FAULT_PLANT_SILENT) != 0 ||
                         status.witness_max_ns > period_ns_ / 2;
  // Packs given up to the machine leave no step of their own; steps made and not heard of are ours to have missed.
  const std::int64_t machine = status.missed_machine - last_status_.missed_machine;
  const std::int64_t unheard = std::max<std::int64_t>(status.step - last_status_.step - 1, 0);
  return std::max<std::int64_t>(disturbed ? 1 : 0, machine) + unheard;
}

void FaultJudge::OnStatus(const estimator_status_t& status) {
  const std::int64_t not_ours = NotOwn(status);
  const std::int64_t unheard = std::max<std::int64_t>(status.step - last_status_.step - 1, 0);
  const std::int64_t dropped = status.packs_dropped - last_status_.packs_dropped;
  last_status_ = status;
  if (!started_) {
    raised_ |= status.fault_flags;
    return;
  }
  while (!finished() && status.last_seq >= slots_[next_].end) FinishSlot();
  if (finished()) {
    steps_.clear();
    return;
  }
  ++statuses_;
  const Slot& slot = slots_[next_];
  steps_.erase(steps_.begin(), steps_.lower_bound(slot.begin - 1));
  if (IsBefore(status, slot)) {
    evidence_.before = evidence_.after = status;
    has_before_ = true;
    if (status.last_seq >= slot.begin) background_ |= status.fault_flags;
    return;
  }
  evidence_.after = status;
  unheard_ += unheard;
  raised_ |= status.fault_flags;
  Step& step = steps_[status.last_seq];
  step.has_status = true;
  step.flags |= status.fault_flags;
  step.miss = std::max(step.miss, status.miss_cause);
  step.not_ours += not_ours;
  step.dropped += dropped;
}

bool FaultJudge::IsBefore(const estimator_status_t& status, const Slot& slot) const {
  if (status.last_seq + 1 >= slot.at() || signalled_) return false;
  // Of an early step, but made when the stages were behind and the pack with the fault had come.
  const std::int64_t due_ns = newest_release_ns_ + (slot.at() - newest_seq_) * period_ns_;
  return slot.fault->source != FaultSource::kPlantPlan || status.t_status_ns < due_ns;
}

void FaultJudge::SignalBegins() {
  evidence_.before = evidence_.after = last_status_;
  has_before_ = signalled_ = true;
}

void FaultJudge::SignalEnds(std::int64_t newest) { affected_until_ = newest; }

bool FaultJudge::Agrees(const Step& step, const Step& reference, bool relearns) const {
  if (!reference_.has_estimate) return true;  // nothing was known before
  for (std::size_t i = 0; i < step.value.size(); ++i) {
    const bool inside = step.value[i] >= reference.lo[i] && step.value[i] <= reference.hi[i];
    const double joint_sd = std::hypot(step.sd[i], reference.sd[i]);
    if (!inside && std::fabs(step.value[i] - reference.value[i]) > kApart * joint_sd) return false;
    const double width = step.hi[i] - step.lo[i], width_before = reference_.hi[i] - reference_.lo[i];
    if (!relearns && width > 4.0 * width_before) return false;
  }
  return true;
}

const char* FaultJudge::ReasonNotNormal(const Step& step, const Step& reference, const FaultSpec& fault) const {
  if (!step.has_estimate) return "no estimate";
  if (!step.has_status) return "no status";
  if (step.truncated) return "truncated";
  if ((step.flags & ~background_) != 0) return "fault flags";
  if (step.miss != estimator_status_t::MISS_NONE) return "missed deadline";
  return Agrees(step, reference, fault.relearns) ? nullptr : "estimate apart";
}

std::int64_t FaultJudge::DroppedRightAfter(std::int64_t seq) const {
  const auto next = steps_.upper_bound(seq);
  if (next == steps_.begin() || next == steps_.end()) return 0;
  return std::min(std::prev(next)->second.dropped, next->first - seq - 1);
}

FaultJudge::Step FaultJudge::Followed(std::int64_t first, std::int64_t last) const {
  Step reference = reference_;
  for (auto found = steps_.lower_bound(first); found != steps_.end() && found->first <= last; ++found) {
    const Step& step = found->second;
    const bool on_time = step.has_status && step.miss == estimator_status_t::MISS_NONE && !step.truncated;
    if (step.has_estimate && on_time && Agrees(step, reference, false)) reference = step;
  }
  return reference;
}

void FaultJudge::FinishSlot() {
  const Slot& slot = slots_[next_];
  const FaultSpec& fault = *slot.fault;
  FaultOutcome outcome;
  outcome.fault = &fault;
  outcome.own_misses = evidence_.after.missed_own - evidence_.before.missed_own;
  // A flag lives in one status: what an earlier one said does not hide a fault that comes after a status without it,
  // and the status of a step that the estimator missed by itself is about that step alone.
  const auto spoilt = fault.source == FaultSource::kEstimatorPlan ? steps_.find(slot.at()) : steps_.end();
  const std::int32_t of_its_step = spoilt != steps_.end() ? spoilt->second.flags : 0;
  outcome.flags = evidence_.flags = (raised_ & ~evidence_.before.fault_flags) | of_its_step;
  const bool from_outside = fault.source == FaultSource::kSignal;
  std::int64_t over = slot.at() + fault.LastsPacks(static_cast<double>(period_ns_) * 1e-6) - 1;
  if (from_outside) over = affected_until_;
  if (fault.source == FaultSource::kPlantEnd) over = 0;
  for (const auto& [seq, step] : steps_) {
    if (seq > slot.at() && seq < slot.end) evidence_.modification = evidence_.modification || step.modification;
  }
  outcome.detected = fault.detected(evidence_);
  // Nothing heard since: this program stood still itself, and cannot judge.
  const bool heard = evidence_.after.t_status_ns > evidence_.before.t_status_ns;
  outcome.injected = has_before_ && heard && (!from_outside || signalled_);
  if (!outcome.detected && unheard_ > 0) outcome.injected = false;  // a flag lives in one status
  if (!outcome.detected && !from_outside && fault.source != FaultSource::kPlantEnd) {
    // Lost on its way, or given up in favour of newer packs before the stage came to it: it did not happen.
    const auto at = steps_.find(slot.at());
    const bool computed = at != steps_.end() && at->second.has_estimate;
    const bool lost = evidence_.Rises(&estimator_status_t::packs_lost);
    if (lost || (fault.source == FaultSource::kEstimatorPlan && !computed)) outcome.injected = false;
  }
  outcome.recovered_steps = kNever;
  if (from_outside) outcome.stalled_steps = DroppedRightAfter(over);
  const bool data_flow_on = from_outside && !fault.misses;
  const Step reference = data_flow_on ? Followed(slot.at(), over) : reference_;
  std::int64_t missing = 0;  // steps without any message, up to the present one
  for (std::int64_t seq = over + 1; seq < slot.end; ++seq) {
    const auto found = steps_.find(seq);
    const Step step = found != steps_.end() ? found->second : Step{};
    const char* hindrance = ReasonNotNormal(step, reference, fault);
    if (hindrance == nullptr) {
      // Of those before it. Packs given up in favour of this one left no step that could have told.
      const std::int64_t given_up = from_outside ? std::min(std::max(step.not_ours, step.dropped), missing) : 0;
      outcome.recovered_steps = seq - over - outcome.stalled_steps - given_up;
      break;
    }
    missing = found != steps_.end() ? 0 : missing + 1;
    outcome.hindrance = hindrance;
    // The backlog of a process that stood still is part of the fault.
    outcome.stalled_steps += from_outside ? std::max(step.not_ours, step.dropped) : step.not_ours;
  }
  if (outcome.recovered_steps != kNever) outcome.recovered_steps = std::max<std::int64_t>(1, outcome.recovered_steps);
  outcome.statuses = std::exchange(statuses_, 0);
  outcomes_.push_back(outcome);
  ++next_;
  reference_ = last_step_;
  evidence_ = {};
  evidence_.before = evidence_.after = last_status_;
  has_before_ = false;
  background_ = raised_ = 0;
  unheard_ = 0;
  signalled_ = false;
  affected_until_ = 0;
}

std::vector<FaultOutcome> FaultJudge::TakeOutcomes() { return std::exchange(outcomes_, {}); }

}  // namespace armcmc::stress
