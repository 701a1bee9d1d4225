#pragma once

#include <filesystem>

#include "armcmc/plant_sim/scenario.hpp"

namespace armcmc::plant_sim {

/// Reads a scenario file strictly. @throws support::ConfigError naming file, line, key and what is allowed.
[[nodiscard]] Scenario LoadScenario(const std::filesystem::path& path);

}  // namespace armcmc::plant_sim
