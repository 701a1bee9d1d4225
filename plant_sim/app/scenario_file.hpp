#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "armcmc/plant_sim/scenario.hpp"

namespace armcmc::plant_sim {

/// Reads a scenario file strictly and decides the effects that it hides.
/// @param duration_s instead of the file's; a gap ratio belongs to a duration.
/// @param seed of the ranges and of the motion that the file leaves to it.
/// @throws support::ConfigError naming file, line, key and what is allowed.
[[nodiscard]] Scenario LoadScenario(const std::filesystem::path& path, std::optional<double> duration_s = {},
                                    std::uint64_t seed = 1);

}  // namespace armcmc::plant_sim
