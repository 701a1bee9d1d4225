#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "armcmc/plant_sim/series.hpp"

namespace armcmc::plant_sim {

/// Reads the columns t (s) and `column` of a CSV file.
/// @param path   As a scenario file gives it: relative to the folder of that file.
/// @param beside The scenario file.
/// @throws support::InputError when the file cannot be read or is not evenly sampled.
[[nodiscard]] std::shared_ptr<const Series> ReadSeries(const std::filesystem::path& path,
                                                       const std::filesystem::path& beside, const std::string& column);

}  // namespace armcmc::plant_sim
