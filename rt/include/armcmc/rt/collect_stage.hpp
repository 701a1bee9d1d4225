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

/// First stage: checks a pack, watches its number and its time, and copies it into the ring.
class CollectStage {
 public:
  CollectStage(const RtSettings& settings, const PackFormat& format, PackRing* ring, Counters* counters,
               EventLog* events) noexcept;

  /// Every usable pack goes there, too, also one that adjust will not come to. Set before the thread starts.
  void SetRecord(RecordRing* record) noexcept { record_ = record; }
  /// Faults of this stage on purpose. Set before the thread starts.
  void SetInjection(Injection* injection) noexcept { injection_ = injection; }

  /// @return true when a pack was handed on. @rt No heap, no lock, no throw, no system call but those of the CPU time
  /// meter. O(pack).
  [[nodiscard]] bool Step(const Datagram& datagram) noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] CpuTimeMeter* cpu_time() noexcept { return &cpu_time_; }

  /// Begins to wait for the plant. Call once, right before the loop.
  void Begin(Nanos now_ns) noexcept ARMCMC_NONBLOCKING;
  /// When Tick() is to be called unless a pack comes before.
  [[nodiscard]] Nanos next_tick_ns() const noexcept { return next_tick_ns_; }
  /// Messages of other channels that the bus has carried so far: a bus that drowns is flagged. Call often. @rt O(1).
  void NoteForeign(std::int64_t foreign, Nanos now_ns) noexcept ARMCMC_NONBLOCKING;
  /// Messages a second of other channels from which on a bus counts as flooded.
  static constexpr std::int64_t kFloodPerSecond = 10'000;
  /// A period passed without a pack. @rt O(1).
  void Tick(Nanos now_ns) noexcept ARMCMC_NONBLOCKING;

 private:
  void PublishSequenceCounts() noexcept ARMCMC_NONBLOCKING;
  void Reject(RejectCause cause, Nanos now_ns) noexcept ARMCMC_NONBLOCKING;
  void NoteClock(bool continues, Nanos now_ns) noexcept ARMCMC_NONBLOCKING;
  /// Whether packs share as many samples as is counted on. @param steps  Difference of the pack numbers.
  void NoteOverlap(std::int64_t steps, Nanos now_ns) noexcept ARMCMC_NONBLOCKING;
  void NoteSilenceOver(std::int64_t seq, Nanos now_ns) noexcept ARMCMC_NONBLOCKING;

  Nanos period_ns_, deadline_ns_;
  int overlap_;
  PackCodec codec_;
  SequenceTracker tracker_;
  ReleaseGrid grid_;
  CpuTimeMeter cpu_time_;
  PackRing* ring_;
  RecordRing* record_ = nullptr;
  Injection* injection_ = nullptr;
  Counters* counters_;
  EventLog* events_;
  Nanos next_tick_ns_ = 0;
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
