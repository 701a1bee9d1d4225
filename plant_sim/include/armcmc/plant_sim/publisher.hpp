#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>

#include "armcmc/plant_sim/latency_histogram.hpp"
#include "armcmc/plant_sim/log_ring.hpp"
#include "armcmc/plant_sim/pack_builder.hpp"
#include "armcmc/plant_sim/pack_sender.hpp"

namespace armcmc::plant_sim {

/// Publishes packs in real time from a thread of its own.
///
/// Pack k is due at its last sample, start + N T + (k - 1) T_s on CLOCK_MONOTONIC (absolute sleeps: the grid never
/// drifts). It is simulated before it is due, and stamped and sent when it is due. A stall of the machine delays packs
/// but loses none: what is overdue is sent at once.
class Publisher {
 public:
  /// @param log also gets every message when not null. All pointers must outlive the publisher.
  Publisher(const Scenario& scenario, std::uint64_t seed, std::int64_t run_id, const std::string& prefix,
            const FaultPlan& faults, MessageSink* bus, LogRing* log);
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Starts; sample 0 is at start_ns.
  void Start(std::int64_t start_ns);
  /// Asks for an end; Join() returns at most 0.1 s later.
  void RequestStop() noexcept { stop_.store(true, std::memory_order_relaxed); }
  void Join();

  [[nodiscard]] bool finished() const noexcept { return finished_.load(std::memory_order_acquire); }
  /// Packs whose turn has come so far, dropped ones included.
  [[nodiscard]] std::int64_t packs_sent() const noexcept { return sent_.load(std::memory_order_acquire); }

  // After Join().
  [[nodiscard]] const LatencyHistogram& lateness() const noexcept { return lateness_; }  ///< Due to handed to the bus.
  /// Packs that the plant itself sent more than a tenth of a period (at least 1 ms) late; wanted delays not counted.
  [[nodiscard]] std::int64_t late_packs() const noexcept { return late_packs_; }
  [[nodiscard]] std::int64_t send_errors() const noexcept { return sender_.errors(); }
  [[nodiscard]] bool diverged() const noexcept { return diverged_; }  ///< The plant left the finite range.

 private:
  /// The bus first, then the log.
  class Tee final : public MessageSink {
   public:
    Tee(MessageSink* bus, LogRing* log) : bus_(bus), log_(log) {}
    bool Send(const char* channel, const void* data, int size, std::int64_t utime) noexcept override;

   private:
    MessageSink* bus_;
    LogRing* log_;
  };

  void Run(std::int64_t start_ns) noexcept;
  /// False when a stop was requested.
  [[nodiscard]] bool WaitUntil(std::int64_t t_ns) const noexcept;

  std::int64_t span_ns_, period_ns_;
  std::int64_t num_packs_;
  FaultPlan faults_;
  PackBuilder builder_;
  Tee tee_;
  PackSender sender_;
  LatencyHistogram lateness_;
  std::int64_t late_packs_ = 0;
  bool diverged_ = false;
  std::atomic<bool> stop_{false}, finished_{false};
  std::atomic<std::int64_t> sent_{0};
  std::thread thread_;
};

}  // namespace armcmc::plant_sim
