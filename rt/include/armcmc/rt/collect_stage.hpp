#pragma once

#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/counters.hpp"
#include "armcmc/rt/cpu_time_meter.hpp"
#include "armcmc/rt/event_log.hpp"
#include "armcmc/rt/hand_over.hpp"
#include "armcmc/rt/injection.hpp"
#include "armcmc/rt/lcm_receiver.hpp"
#include "armcmc/rt/pack_codec.hpp"
#include "armcmc/rt/release_grid.hpp"
#include "armcmc/rt/sequence_tracker.hpp"
#include "armcmc/rt/settings.hpp"

namespace armcmc::rt {

/// First stage: decodes and checks a datagram, follows the numbers and times of the packs, and copies the pack once,
/// into a slot of the ring to adjust.
///
/// A pack is rejected if its type, size, plant or values are wrong (PackCodec), and counted and dropped if its number
/// was seen before (SequenceTracker). Otherwise it is released at the earlier of its arrival and its due time on the
/// sender's grid (ReleaseGrid), so that a late pack does not get a later deadline.
class CollectStage {
 public:
  /// Set-up thread; `ring`, `counters` and `events` must outlive the stage.
  /// @param settings  Period, deadline and overlap of the packs.
  /// @param format    Plant and message type that are accepted; all others are rejected and counted.
  /// @param ring      Output for adjust. If it is full, the pack is dropped and counted.
  /// @param counters  This stage writes only its own group.
  /// @param events    Of this stage.
  CollectStage(const RtSettings& settings, const PackFormat& format, PackRing* ring, Counters* counters,
               EventLog* events) noexcept;

  /// Also copies every usable pack to this ring, including those that adjust drops: for the gap log. Before the thread
  /// starts.
  void SetRecord(RecordRing* record) noexcept { record_ = record; }
  /// Injected faults of this stage; null: none. Before the thread starts.
  void SetInjection(Injection* injection) noexcept { injection_ = injection; }

  /// Processes one datagram.
  /// @return true if a pack was handed to adjust; false if it was rejected or dropped, with the reason in the counters.
  /// @rt No heap, no lock, no throw, no system call except those of the CPU time meter. O(samples of a pack).
  [[nodiscard]] bool Step(const Datagram& datagram) noexcept ARMCMC_NONBLOCKING;

  /// Processor time of the stage; the pipeline reports each wake-up of the thread to it.
  [[nodiscard]] CpuTimeMeter* cpu_time() noexcept { return &cpu_time_; }

  /// Starts to wait for the plant: silence is counted from now_ns, CLOCK_MONOTONIC. Once, right before the loop.
  void Begin(Nanos now_ns) noexcept ARMCMC_NONBLOCKING;
  /// Absolute time, CLOCK_MONOTONIC, at which Tick() is due unless a pack comes before.
  [[nodiscard]] Nanos next_tick_ns() const noexcept { return next_tick_ns_; }
  /// Reports how many messages of other channels the bus has carried since the start. Above kFloodPerSecond,
  /// FAULT_BUS_FLOOD is raised. Call it for every wake-up.
  /// @rt O(1).
  void NoteForeign(std::int64_t foreign, Nanos now_ns) noexcept ARMCMC_NONBLOCKING;
  /// Messages per second of other channels above which a bus counts as flooded.
  static constexpr std::int64_t kFloodPerSecond = 10'000;
  /// A period passed without a pack: counts it, and raises FAULT_PLANT_SILENT. @rt O(1).
  void Tick(Nanos now_ns) noexcept ARMCMC_NONBLOCKING;

 private:
  /// Copies the counts of the tracker to the counters.
  void PublishSequenceCounts() noexcept ARMCMC_NONBLOCKING;
  /// Counts a pack that failed a check, by its cause, and raises FAULT_BAD_DATA.
  void Reject(RejectCause cause, Nanos now_ns) noexcept ARMCMC_NONBLOCKING;
  /// Raises FAULT_CLOCK_JUMP if the clock of the plant jumped. @param continues  The pack continues the previous one.
  void NoteClock(bool continues, Nanos now_ns) noexcept ARMCMC_NONBLOCKING;
  /// Warns once per run if packs do not share the configured number of samples. @param steps  Difference of the pack
  /// numbers.
  void NoteOverlap(std::int64_t steps, Nanos now_ns) noexcept ARMCMC_NONBLOCKING;
  /// The plant is back after silent periods: an event, and the flag ends.
  void NoteSilenceOver(std::int64_t seq, Nanos now_ns) noexcept ARMCMC_NONBLOCKING;

  Nanos period_ns_, deadline_ns_;  ///< From the settings.
  int overlap_;                    ///< Packs that share a sample.
  PackCodec codec_;                ///< Decodes and checks.
  SequenceTracker tracker_;        ///< Numbers and runs.
  ReleaseGrid grid_;               ///< Due times.
  CpuTimeMeter cpu_time_;
  PackRing* ring_;
  RecordRing* record_ = nullptr;
  Injection* injection_ = nullptr;
  Counters* counters_;
  EventLog* events_;
  Nanos next_tick_ns_ = 0;          ///< See next_tick_ns().
  Nanos heard_ns_ = 0;              // newest usable pack, or Begin()
  std::int64_t skipped_steps_ = 0;  // grid points of packs that came and were rejected since the last usable one
  std::int64_t silent_in_a_row_ = 0;
  std::int64_t plant_clock_ns_ = 0;  // of the newest usable pack
  double plant_time_s_ = 0.0;
  bool overlap_told_ = false;        // in this run of the plant
  std::int64_t foreign_before_ = 0;  // at the begin of the window
  Nanos foreign_since_ns_ = 0;
  bool traffic_ = false;  // something came on the channel since the last tick
  bool silence_reported_ = false;
};

}  // namespace armcmc::rt
