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

/// collect -> adjust: packs, written once into their slot. The ring holds what comes during a long stall, and the
/// adjust stage decides what is still worth computing.
struct PackSlot {
  DataPack pack;
  StepTimes times;
};
inline constexpr std::size_t kPackRingCapacity = 128;
using PackRing = SpscRing<PackSlot, kPackRingCapacity>;

/// What travels with an adjusted pack.
struct StepInfo {
  std::int64_t seq = 0, run_id = 0;
  Status status = Status::kOk;  ///< Of adjust.
  StepTimes times;
};

/// adjust -> execute: the newest complete result. info[slot] belongs to the engine's result slot of the same number.
struct ResultHandOver {
  LatestValue latest;
  std::array<StepInfo, LatestValue::kSlots> info;
};

/// execute -> publish.
struct StepOutput {
  StepInfo info;
  MissCause miss = MissCause::kNone;
  Estimate estimate;
};
/// collect -> whoever keeps the data, outside the real-time threads. Full: the newest pack is not kept.
inline constexpr std::size_t kRecordRingCapacity = 256;
using RecordRing = SpscRing<DataPack, kRecordRingCapacity>;
inline constexpr std::size_t kOutputRingCapacity = 16;
using OutputRing = SpscRing<StepOutput, kOutputRingCapacity>;

}  // namespace armcmc::rt
