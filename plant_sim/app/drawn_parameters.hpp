#pragma once

#include <armcmc/support/strict_toml.hpp>
#include <cstdint>
#include <vector>

#include "armcmc/plant_sim/plant.hpp"

namespace armcmc::plant_sim {

/// Reads the table [parameters]: each of the family's a number, or a range from which the seed draws,
///
///   K = { low = 0.3, high = 3.0, law = "log_uniform", at_depth = 0.001, times = "B" }
///
/// law is "uniform" unless given. With at_depth the range is what K x^p is worth at that depth (m), for parameters
/// whose unit holds a power of the depth. With times the range is a multiple of another parameter.
/// @throws support::ConfigError.
[[nodiscard]] std::vector<double> ReadParameters(support::StrictTable table, const PlantFamily& family,
                                                 std::uint64_t seed);

}  // namespace armcmc::plant_sim
