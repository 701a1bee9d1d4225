#include "armcmc/rt/publish_stage.hpp"

#include <utility>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/messages.hpp"

namespace armcmc::rt {

void PublishStage::CountSent(bool sent) noexcept {
  if (sent) {
    counters_->publish.messages.Add();
    return;
  }
  counters_->publish.errors.Add();
  counters_->faults.Raise(estimator_status_t::FAULT_PUBLISH);
  events_->Add({MonotonicNow(), EventKind::kPublishFailed, 0, counters_->publish.errors.Get(), 0});
}

int PublishStage::PublishSteps() noexcept {
  int published = 0;
  for (; published < static_cast<int>(kOutputRingCapacity); ++published) {
    const StepOutput* output = outputs_->Front();
    if (output == nullptr) break;
    const std::int64_t utime = RealtimeMicros();
    FillEstimate(*output, *engine_, utime, &estimate_);
    Send(estimate_, output->info.seq);
    latency_.Add(output->estimate.t_last_ns, output->info.times.arrival_ns, MonotonicNow());
    FillPosterior(*output, *engine_, utime, &posterior_);
    Send(posterior_, output->info.seq);
    FillChange(*output, *engine_, utime, &change_);
    Send(change_, output->info.seq);
    last_ = output->estimate;
    NoteGap(last_.gap);
    PublishStatus(output);
    outputs_->Pop();
  }
  return published;
}

void PublishStage::NoteGap(const GapState& gap) noexcept {
  if (!gap.suspected || gap_alarm_.load(std::memory_order_relaxed) == gap.alarm_seq) return;
  gap_alarm_.store(gap.alarm_seq, std::memory_order_release);
  events_->Add({MonotonicNow(), EventKind::kGapSuspected, static_cast<std::uint8_t>(gap.check), gap.since_seq, 0});
}

void PublishStage::PublishIdleStatus() noexcept { PublishStatus(nullptr); }

void PublishStage::PublishStatus(const StepOutput* output) noexcept {
  StatusContext context;
  context.utime = RealtimeMicros();
  context.now_ns = MonotonicNow();
  context.output = output;
  context.gap = last_.gap;
  context.witness_max_ns = std::exchange(witness_worst_ns_, 0);
  context.fault_flags = counters_->faults.Take();
  if (counters_->collect.silent.load(std::memory_order_relaxed)) {
    context.fault_flags |= estimator_status_t::FAULT_PLANT_SILENT;
  }
  if (std::exchange(hung_, false)) context.fault_flags |= estimator_status_t::FAULT_STAGE_HUNG;
  context.degraded_flags = degraded_flags_.load(std::memory_order_relaxed);
  FillStatus(context, settings_, *counters_, *monitor_, &status_);
  Send(status_, output != nullptr ? output->info.seq : 0);
}

}  // namespace armcmc::rt
