#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/cpu_wake_request.hpp"
#include "armcmc/rt/event_log.hpp"
#include "armcmc/rt/injection.hpp"
#include "armcmc/rt/lane.hpp"
#include "armcmc/rt/lcm_receiver.hpp"
#include "armcmc/rt/rt_thread.hpp"
#include "armcmc/rt/settings.hpp"
#include "armcmc/rt/step_engine.hpp"
#include "armcmc/rt/waiter.hpp"
#include "armcmc/rt/watchdog.hpp"
#include "armcmc/rt/witness.hpp"

namespace armcmc::rt {

/// Heap calls of the calling thread so far; see allocation_counter.hpp.
using HeapProbe = std::uint64_t (*)() noexcept ARMCMC_NONBLOCKING;

/// Options of a run that are not settings of the estimator.
struct PipelineOptions {
  std::int64_t max_steps = 0;      ///< Stop after so many steps of every plant; 0: never.
  HeapProbe heap_probe = nullptr;  ///< nullptr: heap calls of the stages are not counted.
  Injection* injection = nullptr;  ///< Faults on purpose; every status message says so. Outlives the pipeline.
};

/// The real-time estimator: three stages on three pinned threads, pack t collected while t-1 is adjusted and t-2
/// executed; a publisher with a lower priority, a witness per CPU and a watchdog with a higher one.
///
///     LCM -> collect -> ring -> adjust -> latest result -> execute -> ring -> publish -> LCM
///
/// Each stage is woken by the previous one, and every wait is bounded; nothing busy-waits. The owner drains the
/// event logs and prints them.
///
/// Several plants share the threads, the witnesses, the watchdog and the deadline; each has its own Lane. Adjust takes
/// the pack with the earliest deadline, first among those that can still meet theirs; when time is short, the waiting
/// plants share it.
class Pipeline {
 public:
  /// Largest number of plants.
  static constexpr std::size_t kMaxLanes = 16;

  /// Opens the bus and builds everything; no thread runs yet.
  /// @param settings  Of the threads, the timing and the bus; settings.prefix is not read.
  /// @param plants    kMaxLanes at most, no two of them with the same prefix.
  /// @param options   What else is to be done and recorded.
  /// @throws std::invalid_argument from settings.Validate() and for the plants, std::runtime_error when there is no
  /// multicast route.
  Pipeline(const RtSettings& settings, const std::vector<LanePlant>& plants, const PipelineOptions& options);
  /// As above, for one plant, with the prefix of the settings.
  Pipeline(const RtSettings& settings, StepEngine* engine, const PipelineOptions& options)
      : Pipeline(settings, {{engine, settings.prefix, false}}, options) {}
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  /// Locks memory, starts the threads, warms up, and releases the first step. Once only.
  /// @throws PrivilegeError in RtMode::kEnforce; nothing runs then.
  void Start();
  /// Ends the pipeline within one step. Async-signal-safe, from any thread.
  void RequestStop() noexcept ARMCMC_NONBLOCKING;
  /// Whether RequestStop() was called or max_steps are done. Any time, from any thread.
  [[nodiscard]] bool stopping() const noexcept { return stop_.load(std::memory_order_acquire); }
  /// Waits for all threads; finished steps are published first. Follows RequestStop().
  void Join() noexcept;

  /// Number of plants.
  [[nodiscard]] std::size_t num_lanes() const noexcept { return lanes_.size(); }
  /// The lane of a plant, in the order in which the plants were given. @pre i < num_lanes().
  [[nodiscard]] Lane& lane(std::size_t i = 0) noexcept { return *lanes_[i]; }
  [[nodiscard]] const Lane& lane(std::size_t i = 0) const noexcept { return *lanes_[i]; }
  /// Takes one event that is of no lane; by one thread only. @return false when there is none.
  [[nodiscard]] bool TakeEvent(Event* event) noexcept { return watchdog_events_.Take(event); }

  /// false while a thread hangs. Any time.
  [[nodiscard]] bool AllAlive() const noexcept { return watchdog_.hung() == 0; }
  /// Hangs so far. Any time.
  [[nodiscard]] const Watchdog& watchdog() const noexcept { return watchdog_; }
  /// Injected faults; null in service.
  [[nodiscard]] const Injection* injection() const noexcept { return options_.injection; }

  /// The settings as given.
  [[nodiscard]] const RtSettings& settings() const noexcept { return settings_; }
  /// The witness threads, one for each CPU that runs stages; their histograms after Join().
  [[nodiscard]] const std::vector<std::unique_ptr<Witness>>& witnesses() const noexcept { return witnesses_; }
  /// Policy, priority and CPU of every thread, read back from the kernel. After Start().
  [[nodiscard]] std::vector<ThreadPlacement> placements() const;
  /// DEGRADED_* bits: requested real-time measures that are not in effect. After Start().
  [[nodiscard]] std::int32_t degraded_flags() const noexcept { return degraded_flags_; }
  /// Whether idle CPUs are kept from sleeping ([rt] cpu_idle).
  [[nodiscard]] bool cpus_kept_awake() const noexcept { return wake_request_.held(); }
  /// Whether mlockall() succeeded.
  [[nodiscard]] bool memory_locked() const noexcept { return memory_locked_; }
  /// Whether heap calls of the stages are counted, which needs a probe.
  [[nodiscard]] bool heap_calls_counted() const noexcept { return options_.heap_probe != nullptr; }

 private:
  void StartThreads();
  void StartWitnesses();  ///< One for each CPU that runs a stage.
  /// Tells the meter of every stage which other threads run on its CPU.
  void ShareCpuTimes();
  void Place();          ///< With one available CPU, puts all stages there; sets DEGRADED_SHARED_CPU.
  void KeepCpusAwake();  ///< [rt] cpu_idle.
  const ThreadPlacement& StartThread(RtThread* thread, const char* name, const ThreadSettings& settings,
                                     RtThread::Entry entry);

  void WarmUpEngines() noexcept;
  // Everything between two waits is checked to be non-blocking; the waits are in Waiter, LcmReceiver and SleepUntil().
  void CollectLoop() noexcept ARMCMC_NONBLOCKING;
  void AdjustLoop() noexcept ARMCMC_NONBLOCKING;
  /// Packs that wait, whichever plant they are of, and what they leave to be remembered.
  void AdjustWaiting() noexcept ARMCMC_NONBLOCKING;
  /// The lane whose pack is next, null where none waits that can be taken. @param[out] waiting  How many have packs.
  [[nodiscard]] Lane* NextToAdjust(int* waiting) noexcept ARMCMC_NONBLOCKING;
  void RememberIn(Lane* lane) noexcept ARMCMC_NONBLOCKING;
  void ExecuteLoop() noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] bool AllStepsDone() const noexcept ARMCMC_NONBLOCKING;
  void PublishLoop() noexcept ARMCMC_NONBLOCKING;
  /// Updates the counter of a stage. @param baseline  Heap calls of its thread at the end of the warm-up.
  void CountHeapCalls(Stage stage, std::uint64_t baseline) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] std::uint64_t HeapCalls() const noexcept ARMCMC_NONBLOCKING;

  RtSettings settings_;
  PipelineOptions options_;
  std::vector<std::unique_ptr<Lane>> lanes_;
  EventLog watchdog_events_;  ///< Events of no plant in particular.
  LcmReceiver receiver_;      ///< One socket for all plants.
  Watchdog watchdog_;

  Waiter adjust_waiter_, execute_waiter_, publish_waiter_, warm_waiter_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> execute_ended_{false};  // nothing more to publish
  std::vector<std::unique_ptr<Witness>> witnesses_;
  RtThread collect_thread_, adjust_thread_, execute_thread_, publish_thread_;
  std::int32_t degraded_flags_ = 0;
  bool memory_locked_ = false;
  CpuWakeRequest wake_request_;  ///< Held while the pipeline lives.
};

/// Names of the DEGRADED_* bits that are set, for people.
[[nodiscard]] std::vector<std::string> DegradedNames(std::int32_t flags);

}  // namespace armcmc::rt
