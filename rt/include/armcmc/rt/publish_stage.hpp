#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/counters.hpp"
#include "armcmc/rt/deadline_monitor.hpp"
#include "armcmc/rt/event_log.hpp"
#include "armcmc/rt/hand_over.hpp"
#include "armcmc/rt/injection.hpp"
#include "armcmc/rt/lcm_publisher.hpp"
#include "armcmc/rt/publication_latency.hpp"
#include "armcmc/rt/settings.hpp"
#include "armcmc/rt/step_engine.hpp"

namespace armcmc::rt {

/// Turns outputs of execute into messages and sends them. It runs on the thread with the lowest priority of the
/// pipeline, since sending blocks; a slow bus delays messages, never an estimate.
///
/// A step gives four messages, in this order: estimate_t, posterior_t, change_t (with the sequence number of the pack)
/// and estimator_status_t. A message that cannot be sent is counted in Counters::publish.errors, raises FAULT_PUBLISH
/// and is recorded in the event log; it is not sent again, since the next step replaces it.
///
/// Threads: everything without another remark is for the publish thread.
class PublishStage {
 public:
  /// Set-up thread; the arguments must outlive the stage.
  /// @param settings   Periods and thread settings that the status repeats.
  /// @param engine     Names of modes and parameters.
  /// @param outputs    Finished steps, from execute.
  /// @param publisher  Used by this stage only.
  /// @param monitor    Deadlines and stage times for the status.
  /// @param counters, events  Read for the status; this stage writes only its own group.
  PublishStage(const RtSettings& settings, const StepEngine* engine, OutputRing* outputs, LcmPublisher* publisher,
               const DeadlineMonitor* monitor, Counters* counters, EventLog* events) noexcept
      : settings_(settings),
        engine_(engine),
        outputs_(outputs),
        publisher_(publisher),
        monitor_(monitor),
        counters_(counters),
        events_(events) {}

  /// Injected faults of publication; null: none. Before the thread starts.
  /// @param injection  Outlives the stage.
  void SetInjection(Injection* injection) noexcept { injection_ = injection; }
  /// DEGRADED_* bits for the following status messages: real-time measures that are not in effect. Any thread, any
  /// time.
  void SetDegraded(std::int32_t flags) noexcept { degraded_flags_.store(flags, std::memory_order_relaxed); }

  /// Adds evidence about the machine to the next status: the longest delay of a witness thread in ns, and whether the
  /// watchdog found a stage that hangs. By the publish thread.
  void Note(Nanos witness_worst_ns, bool hung) noexcept ARMCMC_NONBLOCKING {
    witness_worst_ns_ = std::max(witness_worst_ns_, witness_worst_ns);
    hung_ = hung_ || hung;
  }

  /// Sends estimate, posterior, change and status of all finished steps, oldest first. Steps that finish meanwhile are
  /// sent as well, up to the limit, so that a call ends.
  /// @return their number, at most kOutputRingCapacity.
  /// @rt No heap, no throw. Blocks in the socket.
  int PublishSteps() noexcept ARMCMC_NONBLOCKING;
  /// Sends a status without a step: no pack came in this period, or none was finished. @rt As PublishSteps().
  void PublishIdleStatus() noexcept ARMCMC_NONBLOCKING;

  /// Number of the pack at which the gap watch raised its newest alarm; 0: it has not. Any thread may read it: the gap
  /// log polls it to learn when the recent packs are to be saved.
  [[nodiscard]] const std::atomic<std::int64_t>& gap_alarm() const noexcept { return gap_alarm_; }
  /// The newest published estimate, for the report at the end; in its initial state if there was none.
  /// @pre the thread has ended.
  [[nodiscard]] const Estimate& last_estimate() const noexcept { return last_; }
  /// Times from the last sample and from the arrival of the pack to the sent message, over all published estimates.
  /// @pre the thread has ended.
  [[nodiscard]] const PublicationLatency& latency() const noexcept { return latency_; }

 private:
  /// Status of a step, or of a period without one (nullptr). Takes the raised faults and the noted evidence with it,
  /// so that each is reported once.
  void PublishStatus(const StepOutput* output) noexcept ARMCMC_NONBLOCKING;
  /// Stores a new alarm of the gap watch for gap_alarm(), and records it in the event log.
  void NoteGap(const GapState& gap) noexcept ARMCMC_NONBLOCKING;
  /// Sends one message and counts what became of it. @param pack  That it belongs to, 0: none.
  template <typename Message>
  void Send(const Message& message, std::int64_t pack) noexcept ARMCMC_NONBLOCKING {
    CountSent((injection_ == nullptr || !injection_->FailsPublication(pack)) && publisher_->Publish(message));
  }
  /// Counts a message, or an error and FAULT_PUBLISH.
  void CountSent(bool sent) noexcept ARMCMC_NONBLOCKING;

  /// What the constructor was given.
  const RtSettings& settings_;
  const StepEngine* engine_;
  OutputRing* outputs_;
  LcmPublisher* publisher_;
  const DeadlineMonitor* monitor_;
  Counters* counters_;
  EventLog* events_;
  Injection* injection_ = nullptr;
  /// Noted since the last status.
  Nanos witness_worst_ns_ = 0;
  bool hung_ = false;
  std::atomic<std::int32_t> degraded_flags_{0};
  std::atomic<std::int64_t> gap_alarm_{0};
  /// Filled again for every step.
  estimate_t estimate_{};
  posterior_t posterior_{};
  change_t change_{};
  estimator_status_t status_{};
  Estimate last_;
  PublicationLatency latency_;
};

}  // namespace armcmc::rt
