#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "armcmc/stress/fault_catalog.hpp"

namespace armcmc::stress {

/// The packs of one run of the plant in which one fault happens and the estimator recovers: [begin, end).
struct Slot {
  static constexpr std::int64_t kQuietBefore = 3;  ///< Packs of a slot before its fault.

  const FaultSpec* fault = nullptr;
  std::int64_t begin = 0, end = 0;
  [[nodiscard]] std::int64_t at() const { return begin + kQuietBefore; }  ///< First pack that the fault touches.
};

/// Which fault happens at which pack, in every run of the plant again.
struct FaultLayout {
  std::vector<Slot> slots;
  std::string plant_plan;      ///< For armcmc-plant --inject; may be empty.
  std::string estimator_plan;  ///< For [inject] plan; may be empty.
  std::int64_t last_pack = 0;  ///< End of the last slot.
};

/// Packs before the first fault, in which the estimator learns.
[[nodiscard]] std::int64_t LearningPacks(double period_ms);

/// Lays faults out one after the other, from number `first` of the list on and around it at most once, as far as
/// `packs` reach. Faults of the end of a plant take no slot.
[[nodiscard]] FaultLayout LayOut(const std::vector<const FaultSpec*>& faults, std::size_t first, double period_ms,
                                 std::int64_t packs);

}  // namespace armcmc::stress
