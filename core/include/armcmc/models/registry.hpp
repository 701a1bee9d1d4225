#pragma once

#include <array>

#include "armcmc/models/hunt_crossley.hpp"
#include "armcmc/models/soft_actuator.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc {

template <class... Models>
struct ModelList {
  static constexpr int kSize = sizeof...(Models);
  static constexpr std::array<const ModelInfo*, sizeof...(Models)> kInfos{&Models::kInfo...};
  using PrepareFn = void (*)(const DataPack&, const PlantConstants&, int, ModeData*) noexcept ARMCMC_NONBLOCKING;
  static constexpr std::array<PrepareFn, sizeof...(Models)> kPrepare{&Models::Prepare...};
};

/// Every forward model. The index into this list identifies a model inside the estimator.
using AllModels = ModelList<HuntCrossley, SoftActuator>;

/// Index of the model with that name, -1 if there is none.
[[nodiscard]] constexpr int FindModel(std::string_view name) noexcept {
  for (int i = 0; i < AllModels::kSize; ++i)
    if (AllModels::kInfos[static_cast<std::size_t>(i)]->name == name) return i;
  return -1;
}

}  // namespace armcmc
