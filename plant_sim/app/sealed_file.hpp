#pragma once

#include <cstdint>
#include <string>

#include "armcmc/plant_sim/scenario.hpp"

namespace armcmc::plant_sim {

/// Writes what a scenario hides as JSON, for the scorer alone: kind, gap ratio, and of each effect its name, formula,
/// gate, parameters and own gap ratio; with the base parameters at t = 0, the noise of each channel, and every option
/// of the plant by table ("motion"). All in SI units.
/// @return the SHA-256 of the file, which may be shown before it is opened.
/// @throws std::runtime_error when it cannot be written.
std::string WriteSealedFile(const Scenario& scenario, std::uint64_t seed, const std::string& path);

}  // namespace armcmc::plant_sim
