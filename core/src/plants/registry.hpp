#pragma once

#include <array>

#include "armcmc/model.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "plants/soft_actuator/model.hpp"

namespace armcmc {

template <class... Models>
struct ModelList {
  static constexpr int kSize = sizeof...(Models);
  static constexpr std::array<const ModelInfo*, sizeof...(Models)> kInfos{&Models::kInfo...};
};

/// The compiled plants, for loops that are instantiated for each of them: the only list of them, apart from
/// kernels.inl. The order is that of CompiledModels().
using AllModels = ModelList<HuntCrossley, SoftActuator>;

}  // namespace armcmc
