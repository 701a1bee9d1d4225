#pragma once

#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

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
#include "armcmc/rt/watchdog.hpp"
#include "armcmc/rt/witness.hpp"

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

  /// Set before the thread starts.
  void SetWitnesses(std::vector<Witness*> witnesses) { witnesses_ = std::move(witnesses); }
  /// Set before the thread starts; nullptr: no faults on purpose, no watchdog.
  void SetInjection(Injection* injection) noexcept { injection_ = injection; }
  void SetWatchdog(Watchdog* watchdog) noexcept { watchdog_ = watchdog; }
  /// Any time.
  void SetDegraded(std::int32_t flags) noexcept { degraded_flags_.store(flags, std::memory_order_relaxed); }

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
    Note((injection_ == nullptr || !injection_->FailsPublication(pack)) && publisher_->Publish(message));
  }
  void Note(bool sent) noexcept ARMCMC_NONBLOCKING;

  const RtSettings& settings_;
  const StepEngine* engine_;
  OutputRing* outputs_;
  LcmPublisher* publisher_;
  const DeadlineMonitor* monitor_;
  Counters* counters_;
  EventLog* events_;
  std::vector<Witness*> witnesses_;
  Injection* injection_ = nullptr;
  Watchdog* watchdog_ = nullptr;
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
