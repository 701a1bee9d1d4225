#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <string>

#include "armcmc/rt/adjust_stage.hpp"
#include "armcmc/rt/collect_stage.hpp"
#include "armcmc/rt/counters.hpp"
#include "armcmc/rt/deadline_monitor.hpp"
#include "armcmc/rt/event_log.hpp"
#include "armcmc/rt/execute_stage.hpp"
#include "armcmc/rt/hand_over.hpp"
#include "armcmc/rt/injection.hpp"
#include "armcmc/rt/lcm_publisher.hpp"
#include "armcmc/rt/publish_stage.hpp"
#include "armcmc/rt/settings.hpp"
#include "armcmc/rt/step_engine.hpp"

namespace armcmc::rt {

/// A plant that a pipeline estimates, as it is passed to its constructor.
struct LanePlant {
  StepEngine* engine = nullptr;  ///< Outlives the pipeline.
  std::string prefix;            ///< Prefix of its channels.
  bool record_packs = false;     ///< Keep copies of its packs for Lane::record().
};

/// The part of a pipeline that belongs to one plant: its stages, the rings between them, counters, deadlines and
/// messages. The threads belong to the pipeline and serve all lanes, each stage of every lane on the same thread.
///
///   bus -> collect -> PackRing -> adjust -> ResultHandOver -> execute -> OutputRing -> publish -> bus
///
/// The constructor allocates everything; the engine, which holds the draws, belongs to the caller.
class Lane {
 public:
  /// @param settings   Must outlive the lane.
  /// @param plant      Plant, prefix of its channels, and whether its packs are recorded.
  /// @param injection  Injected faults; null: none. Must outlive the lane.
  /// @throws std::runtime_error  if the bus cannot be opened.
  Lane(const RtSettings& settings, const LanePlant& plant, Injection* injection);
  Lane(const Lane&) = delete;
  Lane& operator=(const Lane&) = delete;

  /// The computation of this plant.
  [[nodiscard]] const StepEngine& engine() const noexcept { return *engine_; }
  /// Prefix of its channels; may be empty.
  [[nodiscard]] const std::string& prefix() const noexcept { return prefix_; }
  /// Channel on which its packs are expected: prefix and PLANT_PACK or PLANT_PACK_V2.
  [[nodiscard]] std::string channel() const { return prefix_ + engine_->pack_format().channel(); }

  /// Counters since the start. Any time, from any thread.
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
  /// Deadlines met and missed, stage times. @pre the pipeline has ended.
  [[nodiscard]] const DeadlineMonitor& monitor() const noexcept { return monitor_; }
  /// Third stage, with its histograms of draws and effective sample sizes. @pre the pipeline has ended.
  [[nodiscard]] const ExecuteStage& execute() const noexcept { return execute_; }
  /// Newest published estimate. @pre the pipeline has ended.
  [[nodiscard]] const Estimate& last_estimate() const noexcept { return publish_.last_estimate(); }
  /// Age of the data when their estimate has been sent, from arrival and from the last sample. @pre the pipeline has
  /// ended.
  [[nodiscard]] const PublicationLatency& latency() const noexcept { return publish_.latency(); }

  /// Raises FAULT_* bits in the next status message. Any time, from any thread. @rt Wait-free.
  void RaiseFault(std::int32_t flags) noexcept { counters_.faults.Raise(flags); }
  /// Usable packs, for one reader; null without LanePlant::record_packs.
  [[nodiscard]] RecordRing* record() noexcept { return record_.get(); }
  /// Number of the pack at which the gap watch raised its alarm, 0 while it has not. Any time.
  [[nodiscard]] const std::atomic<std::int64_t>& gap_alarm() const noexcept { return publish_.gap_alarm(); }
  /// Takes one event of any thread; by one thread only. @return false when there is none.
  [[nodiscard]] bool TakeEvent(Event* event) noexcept;
  /// Events that were lost because a log was full. Any time.
  [[nodiscard]] std::int64_t events_dropped() const noexcept;

 private:
  friend class Pipeline;

  StepEngine* engine_;                  ///< The computation; belongs to the caller.
  std::string prefix_;                  ///< Prefix of all channels of this plant.
  Counters counters_;                   ///< Written by the stages, each in its own group.
  DeadlineMonitor monitor_;             ///< Stage times and verdicts on deadlines.
  std::array<EventLog, 4> events_;      // collect, adjust, execute, publish: one producer each
  PackRing packs_;                      ///< collect -> adjust.
  ResultHandOver results_;              ///< adjust -> execute.
  OutputRing outputs_;                  ///< execute -> publish.
  std::unique_ptr<RecordRing> record_;  ///< collect -> a reader outside; null without record_packs.
  LcmPublisher publisher_;              ///< Used by the publish thread only.
  CollectStage collect_;
  AdjustStage adjust_;
  ExecuteStage execute_;
  PublishStage publish_;
  bool not_remembered_ = false;          // of adjust: what its newest step left to Remember()
  bool refused_ = false;                 // of adjust: execute has to come first
  std::atomic<bool> status_due_{false};  // collect asks for a status message
};

}  // namespace armcmc::rt
