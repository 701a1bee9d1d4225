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

/// Third stage: summarises the newest result of adjust, predicts the output, and judges the step against its deadline.
///
/// Estimate, intervals and prediction come from StepEngine::Execute(). The deadline is judged here, when the estimate
/// is complete in memory: publishing is measured separately (PublicationLatency). A missed step is attributed to a
/// cause by the DeadlineMonitor. The estimate of a missed step is published like any other; the status of
/// that step names the cause.
class ExecuteStage {
 public:
  /// Constructed on the set-up thread; the arguments must outlive the stage. Allocates the spare output.
  /// @param engine   Runs Execute() on the slots that adjust handed over.
  /// @param results  Input: newest result, with the times of its step.
  /// @param outputs  Output for the publish stage. If the ring is full, the step is finished and counted
  ///   (Counters::Execute::unpublished), but not published.
  /// @param monitor  Judges every step.
  /// @param counters, events  Written by this stage only in its own group.
  ExecuteStage(StepEngine* engine, ResultHandOver* results, OutputRing* outputs, DeadlineMonitor* monitor,
               Counters* counters, EventLog* events);

  /// Finishes one step.
  /// @return true if a step was finished; false if there is no new result.
  /// @rt No heap, no lock, no throw, no system call except those of the CPU time meter. O(draws).
  [[nodiscard]] bool Step() noexcept ARMCMC_NONBLOCKING;

  /// Processor time of the stage; the pipeline reports each wake-up of the thread to it.
  [[nodiscard]] CpuTimeMeter* cpu_time() noexcept { return &cpu_time_; }

  /// Number of draws of every posterior that was updated. @pre the stage has ended.
  [[nodiscard]] const LogHistogram& draws() const noexcept { return draws_; }
  /// Effective sample size of the chain of every posterior that was updated. @pre the stage has ended.
  [[nodiscard]] const LogHistogram& ess() const noexcept { return ess_; }

 private:
  /// Adds draws and effective sample sizes of the modes that the step updated.
  void CountSampling(const Estimate& estimate) noexcept ARMCMC_NONBLOCKING;

  /// What the constructor was given.
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
