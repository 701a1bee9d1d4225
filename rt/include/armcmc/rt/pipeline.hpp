#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/adjust_stage.hpp"
#include "armcmc/rt/collect_stage.hpp"
#include "armcmc/rt/counters.hpp"
#include "armcmc/rt/cpu_wake_request.hpp"
#include "armcmc/rt/deadline_monitor.hpp"
#include "armcmc/rt/event_log.hpp"
#include "armcmc/rt/execute_stage.hpp"
#include "armcmc/rt/hand_over.hpp"
#include "armcmc/rt/injection.hpp"
#include "armcmc/rt/lcm_publisher.hpp"
#include "armcmc/rt/lcm_receiver.hpp"
#include "armcmc/rt/publish_stage.hpp"
#include "armcmc/rt/rt_thread.hpp"
#include "armcmc/rt/settings.hpp"
#include "armcmc/rt/step_engine.hpp"
#include "armcmc/rt/waiter.hpp"
#include "armcmc/rt/watchdog.hpp"
#include "armcmc/rt/witness.hpp"

namespace armcmc::rt {

/// Heap calls of the calling thread so far; see allocation_counter.hpp.
using HeapProbe = std::uint64_t (*)() noexcept ARMCMC_NONBLOCKING;

struct PipelineOptions {
  std::int64_t max_steps = 0;      ///< Stop after so many steps; 0: never.
  HeapProbe heap_probe = nullptr;  ///< nullptr: heap calls of the stages are not counted.
  bool record_packs = false;       ///< Keep copies of the packs for record().
  Injection* injection = nullptr;  ///< Faults on purpose; every status message says so. Outlives the pipeline.
};

/// The real-time estimator: three stages on three pinned threads, pack t collected while t-1 is adjusted and t-2
/// executed, a publisher below them a witness per CPU and a watchdog above them.
///
///     LCM -> collect -> ring -> adjust -> latest result -> execute -> ring -> publish -> LCM
///
/// Stages are woken by the one before, and every wait is bounded; nothing spins. The owner drains the
/// event logs and prints them.
class Pipeline {
 public:
  /// Opens the bus and builds everything; no thread runs yet.
  /// @param engine  Outlives the pipeline.
  /// @throws std::invalid_argument from settings.Validate(), std::runtime_error when there is no multicast route.
  Pipeline(const RtSettings& settings, StepEngine* engine, const PipelineOptions& options);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  /// Locks memory, starts the threads, warms up, and releases the first step. Once only.
  /// @throws PrivilegeError in RtMode::kEnforce; nothing runs then.
  void Start();
  /// Ends the pipeline within one step. Async-signal-safe, from any thread.
  void RequestStop() noexcept ARMCMC_NONBLOCKING;
  /// true after RequestStop() or when max_steps are done.
  [[nodiscard]] bool stopping() const noexcept { return stop_.load(std::memory_order_acquire); }
  /// Flags a fault of another thread in the next status message. Any time, from any thread.
  void RaiseFault(std::int32_t flags) noexcept { counters_.faults.Raise(flags); }
  /// Waits for all threads; finished steps are published first. Follows RequestStop().
  void Join() noexcept;

  /// Takes one event of any thread; by one thread only. @return false when there is none.
  [[nodiscard]] bool TakeEvent(Event* event) noexcept;
  [[nodiscard]] std::int64_t events_dropped() const noexcept;

  /// Usable packs for one reader; nullptr without record_packs.
  [[nodiscard]] RecordRing* record() noexcept { return record_.get(); }
  /// Number of the pack at which the gap watch raised its alarm, 0 while it has not. Any time.
  [[nodiscard]] const std::atomic<std::int64_t>& gap_alarm() const noexcept { return publish_.gap_alarm(); }

  /// false while a thread hangs. Any time.
  [[nodiscard]] bool AllAlive() const noexcept { return watchdog_.hung() == 0; }
  [[nodiscard]] const Watchdog& watchdog() const noexcept { return watchdog_; }
  [[nodiscard]] const Injection* injection() const noexcept { return options_.injection; }

  // What a report needs. Counters may be read any time; the rest after Join().
  [[nodiscard]] const RtSettings& settings() const noexcept { return settings_; }
  [[nodiscard]] const StepEngine& engine() const noexcept { return *engine_; }
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
  [[nodiscard]] const DeadlineMonitor& monitor() const noexcept { return monitor_; }
  [[nodiscard]] const ExecuteStage& execute() const noexcept { return execute_; }
  [[nodiscard]] const Estimate& last_estimate() const noexcept { return publish_.last_estimate(); }
  [[nodiscard]] const PublicationLatency& latency() const noexcept { return publish_.latency(); }
  [[nodiscard]] const std::vector<std::unique_ptr<Witness>>& witnesses() const noexcept { return witnesses_; }
  [[nodiscard]] std::vector<ThreadPlacement> placements() const;
  [[nodiscard]] std::int32_t degraded_flags() const noexcept { return degraded_flags_; }
  [[nodiscard]] bool cpus_kept_awake() const noexcept { return wake_request_.held(); }
  [[nodiscard]] bool memory_locked() const noexcept { return memory_locked_; }
  [[nodiscard]] bool heap_calls_counted() const noexcept { return options_.heap_probe != nullptr; }

 private:
  void StartThreads();
  void StartWitnesses();
  /// Tells the meter of every stage which other threads run on its CPU.
  void ShareCpuTimes();
  void Place();
  void KeepCpusAwake();
  const ThreadPlacement& StartThread(RtThread* thread, const char* name, const ThreadSettings& settings,
                                     RtThread::Entry entry);

  void WarmUpEngine() noexcept;
  // Everything between two waits is checked to be non-blocking; the waits are in Waiter, LcmReceiver and SleepUntil().
  void CollectLoop() noexcept ARMCMC_NONBLOCKING;
  void AdjustLoop() noexcept ARMCMC_NONBLOCKING;
  void ExecuteLoop() noexcept ARMCMC_NONBLOCKING;
  void PublishLoop() noexcept ARMCMC_NONBLOCKING;
  void CountHeapCalls(Stage stage, std::uint64_t baseline) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] std::uint64_t HeapCalls() const noexcept ARMCMC_NONBLOCKING;

  RtSettings settings_;
  PipelineOptions options_;
  StepEngine* engine_;
  Counters counters_;
  DeadlineMonitor monitor_;
  std::array<EventLog, 5> events_;  // collect, adjust, execute, publish, watchdog: one producer each
  PackRing packs_;
  ResultHandOver results_;
  OutputRing outputs_;
  std::unique_ptr<RecordRing> record_;
  LcmReceiver receiver_;
  LcmPublisher publisher_;
  CollectStage collect_;
  AdjustStage adjust_;
  ExecuteStage execute_;
  PublishStage publish_;
  Watchdog watchdog_;

  Waiter adjust_waiter_, execute_waiter_, publish_waiter_, warm_waiter_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> status_due_{false};     // collect asks for a status message
  std::atomic<bool> execute_ended_{false};  // nothing more to publish
  std::vector<std::unique_ptr<Witness>> witnesses_;
  RtThread collect_thread_, adjust_thread_, execute_thread_, publish_thread_;
  std::int32_t degraded_flags_ = 0;
  bool memory_locked_ = false;
  CpuWakeRequest wake_request_;
};

/// Names of the DEGRADED_* bits that are set, for people.
[[nodiscard]] std::vector<std::string> DegradedNames(std::int32_t flags);

}  // namespace armcmc::rt
