#pragma once

#include <cstdint>
#include <string_view>

#include "armcmc/data_pack.hpp"

namespace armcmc::rt {

/// What the packs of a plant look like on the bus: data_pack_t of a compiled plant, data_pack_v2_t of one that a file
/// describes.
struct PackFormat {
  PlantNumber plant = PlantNumber::kNone;
  int num_inputs = 0;
  std::string_view name = {};     ///< Of a described plant; outlives whoever is given the format.
  std::uint64_t fingerprint = 0;  ///< Of a described plant's signals.
  int overlap = 1;                ///< EstimatorSettings::overlap, of which the number of samples is a multiple.

  /// The channel behind the prefix.
  [[nodiscard]] const char* channel() const noexcept {
    return plant == PlantNumber::kDescribed ? "PLANT_PACK_V2" : "PLANT_PACK";
  }
};

}  // namespace armcmc::rt
