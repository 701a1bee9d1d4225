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

/// Turns outputs into messages and sends them. Runs on the thread with the lowest priority, since sending blocks.
class PublishStage {
 public:
  PublishStage(const RtSettings& settings, const StepEngine* engine, OutputRing* outputs, LcmPublisher* publisher,
               const DeadlineMonitor* monitor, Counters* counters, EventLog* events) noexcept
      : settings_(settings),
        engine_(engine),
        outputs_(outputs),
        publisher_(publisher),
        monitor_(monitor),
        counters_(counters),
        events_(events) {}

  /// Set before the thread starts; nullptr: no faults on purpose.
  void SetInjection(Injection* injection) noexcept { injection_ = injection; }
  /// Any time.
  void SetDegraded(std::int32_t flags) noexcept { degraded_flags_.store(flags, std::memory_order_relaxed); }

  /// What the next status says of the machine: the worst delay of a witness, and whether a thread hung.
  void Note(Nanos witness_worst_ns, bool hung) noexcept ARMCMC_NONBLOCKING {
    witness_worst_ns_ = std::max(witness_worst_ns_, witness_worst_ns);
    hung_ = hung_ || hung;
  }

  /// Sends the messages of all finished steps. @return their number, at most kOutputRingCapacity.
  int PublishSteps() noexcept ARMCMC_NONBLOCKING;
  /// Sends a status without a step: nothing came, or nothing was finished.
  void PublishIdleStatus() noexcept ARMCMC_NONBLOCKING;

  /// Number of the pack at which the gap watch raised its alarm; 0: it has not.
  [[nodiscard]] const std::atomic<std::int64_t>& gap_alarm() const noexcept { return gap_alarm_; }
  /// The newest estimate that was published. @pre the thread has ended.
  [[nodiscard]] const Estimate& last_estimate() const noexcept { return last_; }
  /// Of all estimates that were published. @pre the thread has ended.
  [[nodiscard]] const PublicationLatency& latency() const noexcept { return latency_; }

 private:
  void PublishStatus(const StepOutput* output) noexcept ARMCMC_NONBLOCKING;
  void NoteGap(const GapState& gap) noexcept ARMCMC_NONBLOCKING;
  /// Sends one message and counts what became of it. @param pack  That it belongs to, 0: none.
  template <typename Message>
  void Send(const Message& message, std::int64_t pack) noexcept ARMCMC_NONBLOCKING {
    CountSent((injection_ == nullptr || !injection_->FailsPublication(pack)) && publisher_->Publish(message));
  }
  void CountSent(bool sent) noexcept ARMCMC_NONBLOCKING;

  const RtSettings& settings_;
  const StepEngine* engine_;
  OutputRing* outputs_;
  LcmPublisher* publisher_;
  const DeadlineMonitor* monitor_;
  Counters* counters_;
  EventLog* events_;
  Injection* injection_ = nullptr;
  Nanos witness_worst_ns_ = 0;
  bool hung_ = false;
  std::atomic<std::int32_t> degraded_flags_{0};
  std::atomic<std::int64_t> gap_alarm_{0};
  estimate_t estimate_{};
  posterior_t posterior_{};
  change_t change_{};
  estimator_status_t status_{};
  Estimate last_;
  PublicationLatency latency_;
};

}  // namespace armcmc::rt
