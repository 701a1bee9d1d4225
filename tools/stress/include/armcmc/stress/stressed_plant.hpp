#pragma once

#include <cstdint>
#include <string>

namespace armcmc::stress {

/// The plant that both programs run under stress.
struct StressedPlant {
  std::int32_t number;   ///< Of its packs: data_pack_t.plant_kind.
  std::string name;      ///< For scenario and configuration.
  std::string scenario;  ///< [parameters], [motion] and the head of the table of the output's noise.
  double noise_std;      ///< Unit of the output, of the plant and of the estimator's belief.
};

/// One plant; plant.toml says which. @throws support::ConfigError where that is wrong.
[[nodiscard]] const StressedPlant& PlantUnderStress();

}  // namespace armcmc::stress
