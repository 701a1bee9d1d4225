#include "armcmc/rt/sequence_tracker.hpp"

namespace armcmc::rt {

SequenceTracker::Result SequenceTracker::Restart(std::int64_t seq, std::int64_t run_id) noexcept {
  if (run_id != run_id_) {
    previous_run_id_ = run_id_;
    has_previous_run_ = true;
  }
  run_id_ = run_id;
  newest_ = first_ = seq;
  seen_ = 1;
  old_in_a_row_ = 0;
  ++counts_.restarts;
  return {SequenceVerdict::kRestart, 1};
}

SequenceTracker::Result SequenceTracker::Old(std::int64_t seq) noexcept {
  old_in_a_row_ = (old_in_a_row_ > 0 && seq == last_old_ + 1) ? old_in_a_row_ + 1 : 1;
  last_old_ = seq;
  if (old_in_a_row_ >= kRestartRun) return Restart(seq, run_id_);
  const std::int64_t age = newest_ - seq;
  // Numbers before the first one of a run were never missed, so they cannot be taken off the lost ones.
  if (age < kWindow && seq >= first_) {
    const std::uint64_t bit = std::uint64_t{1} << age;
    if ((seen_ & bit) != 0) {
      ++counts_.duplicate;
      return {SequenceVerdict::kDuplicate, 0};
    }
    seen_ |= bit;
    if (counts_.lost > 0) --counts_.lost;  // it had been counted when the gap showed
  }
  ++counts_.reordered;
  return {SequenceVerdict::kReordered, 0};
}

SequenceTracker::Result SequenceTracker::OnPack(std::int64_t seq, std::int64_t run_id) noexcept ARMCMC_NONBLOCKING {
  if (!started_) {
    started_ = true;
    newest_ = first_ = seq;
    run_id_ = run_id;
    seen_ = 1;
    return {SequenceVerdict::kFirst, 1};
  }
  if (run_id != run_id_) {
    if (has_previous_run_ && run_id == previous_run_id_) {
      ++counts_.reordered;
      return {SequenceVerdict::kReordered, 0};
    }
    return Restart(seq, run_id);
  }
  const std::int64_t steps = seq - newest_;  // both in [1, 2^62]: no overflow
  if (steps > kMaxGap || steps < -kMaxGap) return Restart(seq, run_id);
  if (steps <= 0) return Old(seq);
  old_in_a_row_ = 0;
  counts_.lost += steps - 1;
  seen_ = steps >= kWindow ? 1 : ((seen_ << steps) | 1U);
  newest_ = seq;
  return {SequenceVerdict::kNext, steps};
}

std::int64_t SequenceTracker::OnUnusable(std::int64_t seq, std::int64_t run_id) noexcept ARMCMC_NONBLOCKING {
  if (!started_ || run_id != run_id_ || seq <= newest_ || seq - newest_ >= kWindow) return 0;
  return OnPack(seq, run_id).steps;
}

}  // namespace armcmc::rt
