#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "armcmc/data_pack.hpp"
#include "armcmc/estimate.hpp"
#include "armcmc/rt/deadline_monitor.hpp"
#include "armcmc/rt/latest_value.hpp"
#include "armcmc/rt/spsc_ring.hpp"
#include "armcmc/status.hpp"

namespace armcmc::rt {

/// collect -> adjust: a pack and the times of its step so far. It is written once, into the slot of the ring where
/// adjust reads it.
struct PackSlot {
  DataPack pack;    ///< Checked by PackCodec.
  StepTimes times;  ///< Release, arrival, deadline, and collect's own.
};
/// The ring holds the packs of a long stall; which of them are still worth computing is decided by adjust. When it is
/// full, the newest pack is dropped and counted.
inline constexpr std::size_t kPackRingCapacity = 128;
using PackRing = SpscRing<PackSlot, kPackRingCapacity>;

/// What accompanies a pack from adjust to the message: identity, outcome and times.
struct StepInfo {
  std::int64_t seq = 0, run_id = 0;  ///< Numbers of the pack.
  Status status = Status::kOk;       ///< Result of adjust.
  StepTimes times;                   ///< Times of collect and adjust; execute adds its own.
};

/// adjust -> execute: the newest complete result. Draws are not copied: the slots belong to the StepEngine, and
/// info[slot] describes its result of the same number. If adjust finishes again before execute takes a result, the
/// newer one replaces it, and the older one counts as not executed.
struct ResultHandOver {
  LatestValue latest;  ///< Number of the slot with the newest result.
  std::array<StepInfo, LatestValue::kSlots>
      info;  ///< Of the result in each slot; owned by the stage that owns the slot.
};

/// execute -> publish: a finished step, with the verdict on its deadline.
struct StepOutput {
  StepInfo info;                      ///< As adjust handed it over, with the times of execute.
  MissCause miss = MissCause::kNone;  ///< kNone: the deadline was kept.
  Estimate estimate;                  ///< What is published.
};
/// collect -> a reader outside the real-time threads, such as the gap log. When the ring is full, the newest pack is
/// not recorded.
inline constexpr std::size_t kRecordRingCapacity = 256;
using RecordRing = SpscRing<DataPack, kRecordRingCapacity>;
/// Capacity of the ring from execute to publish: so many steps may wait while sending blocks.
inline constexpr std::size_t kOutputRingCapacity = 16;
using OutputRing = SpscRing<StepOutput, kOutputRingCapacity>;

}  // namespace armcmc::rt
