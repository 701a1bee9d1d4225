#include "armcmc/rt/execute_stage.hpp"

#include <cmath>

#include "armcmc/rt/clock.hpp"

namespace armcmc::rt {

ExecuteStage::ExecuteStage(StepEngine* engine, ResultHandOver* results, OutputRing* outputs, DeadlineMonitor* monitor,
                           Counters* counters, EventLog* events)
    : engine_(engine),
      results_(results),
      outputs_(outputs),
      monitor_(monitor),
      counters_(counters),
      events_(events),
      spare_(std::make_unique<StepOutput>()) {}

void ExecuteStage::CountSampling(const Estimate& estimate) noexcept {
  for (const ModeEstimate& mode : estimate.modes) {
    if (!mode.updated || mode.draws <= 0) continue;
    draws_.Add(mode.draws);
    if (std::isfinite(mode.ess)) ess_.Add(static_cast<std::int64_t>(std::floor(mode.ess + 0.5)));
  }
}

bool ExecuteStage::Step() noexcept {
  if (!results_->latest.Acquire()) return false;
  const Nanos start_ns = cpu_time_.Start();
  const int result = results_->latest.read_slot();
  StepOutput* claimed = outputs_->Claim();
  StepOutput* output = claimed != nullptr ? claimed : spare_.get();
  engine_->Execute(result, &output->estimate);
  output->info = results_->info[static_cast<std::size_t>(result)];
  StepTimes& times = output->info.times;
  times.start_ns[IndexOf(Stage::kExecute)] = start_ns;
  const Nanos end_ns = MonotonicNow();
  times.end_ns[IndexOf(Stage::kExecute)] = end_ns;
  times.withheld_before_ns[IndexOf(Stage::kExecute)] = cpu_time_.withheld_before_ns();
  times.withheld_ns[IndexOf(Stage::kExecute)] = cpu_time_.End(end_ns);

  output->miss = monitor_->Record(times);
  if (output->miss != MissCause::kNone) {
    events_->Add({end_ns, EventKind::kDeadlineMissed, static_cast<std::uint8_t>(output->miss), output->info.seq,
                  -times.Slack()});
  }
  CountSampling(output->estimate);
  counters_->execute.steps.Add();
  counters_->execute.last_seq.Set(output->info.seq);
  if (claimed != nullptr) {
    outputs_->Commit();
  } else {
    counters_->execute.unpublished.Add();
  }
  return true;
}

}  // namespace armcmc::rt
