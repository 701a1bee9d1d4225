#pragma once

#include <string>

#include "armcmc/plant_sim/scenario.hpp"

namespace armcmc::plant_sim {

/// A scenario of the source tree, by name.
[[nodiscard]] Scenario BuiltinScenario(const std::string& name);
/// The same with perfect sensors.
[[nodiscard]] Scenario NoiselessScenario(const std::string& name);

}  // namespace armcmc::plant_sim
