#pragma once

#include <memory>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/counters.hpp"
#include "armcmc/rt/cpu_time_meter.hpp"
#include "armcmc/rt/deadline_monitor.hpp"
#include "armcmc/rt/event_log.hpp"
#include "armcmc/rt/hand_over.hpp"
#include "armcmc/rt/log_histogram.hpp"
#include "armcmc/rt/step_engine.hpp"

namespace armcmc::rt {

/// Third stage: summarises the newest result, predicts the output, and judges the step against its deadline.
class ExecuteStage {
 public:
  ExecuteStage(StepEngine* engine, ResultHandOver* results, OutputRing* outputs, DeadlineMonitor* monitor,
               Counters* counters, EventLog* events);

  /// @return true when a step was finished; false when there is no new result.
  /// @rt No heap, no lock, no throw, no system call but those of the CPU time meter. O(draws).
  [[nodiscard]] bool Step() noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] CpuTimeMeter* cpu_time() noexcept { return &cpu_time_; }

  /// Draws and effective sample size of every posterior that was updated. @pre the stage has ended.
  [[nodiscard]] const LogHistogram& draws() const noexcept { return draws_; }
  [[nodiscard]] const LogHistogram& ess() const noexcept { return ess_; }

 private:
  void CountSampling(const Estimate& estimate) noexcept ARMCMC_NONBLOCKING;

  StepEngine* engine_;
  ResultHandOver* results_;
  OutputRing* outputs_;
  DeadlineMonitor* monitor_;
  Counters* counters_;
  EventLog* events_;
  std::unique_ptr<StepOutput> spare_;  // the output when the publisher is so late that its ring is full
  CpuTimeMeter cpu_time_;
  LogHistogram draws_, ess_;
};

}  // namespace armcmc::rt
