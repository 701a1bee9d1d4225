#pragma once

#include <armcmc/support/strict_toml.hpp>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "armcmc/plant_sim/scenario.hpp"

namespace armcmc::plant_sim {

/// Reads [noise.CHANNEL] for each input channel of the family, then for its output.
/// @param seed draws a correlation that is given as a range.
/// @param file the scenario file, beside which recorded noise lies.
/// @throws support::ConfigError, or support::InputError for a recorded noise that cannot be read.
[[nodiscard]] std::vector<NoiseLaw> ReadNoise(support::StrictTable table, const PlantFamily& family, std::uint64_t seed,
                                              const std::filesystem::path& file);

/// Measures what `std_share` and `growth` refer to, the rms of the true channel while a mode acts, on the scenario's
/// own plant without effects, and sets the levels that were given as shares of it.
/// @throws std::invalid_argument when the plant's options contradict each other, or such an rms is zero.
void ResolveNoise(Scenario* scenario);

}  // namespace armcmc::plant_sim
