#pragma once

#include <cstdint>
#include <string_view>

#include "armcmc/data_pack.hpp"

namespace armcmc::rt {

/// Format of the packs of a plant on the bus: data_pack_t for a compiled plant, data_pack_v2_t for one that a file
/// describes. A pack whose plant, name, fingerprint or number of inputs differs is rejected.
struct PackFormat {
  PlantNumber plant = PlantNumber::kNone;  ///< kDescribed: by a file; else the number of a compiled plant.
  int num_inputs = 0;                      ///< Signals besides the output, in the order of the plant.
  std::string_view name = {};              ///< Name of a described plant; must outlive the format.
  std::uint64_t fingerprint = 0;           ///< Fingerprint of a described plant's signals.
  int overlap = 1;  ///< EstimatorSettings::overlap, of which the number of samples is a multiple.

  /// Name of the channel, without the prefix; static storage. @rt No heap, no lock, no throw. O(1).
  [[nodiscard]] const char* channel() const noexcept {
    return plant == PlantNumber::kDescribed ? "PLANT_PACK_V2" : "PLANT_PACK";
  }
};

}  // namespace armcmc::rt
