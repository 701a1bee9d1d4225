#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace armcmc::support {

/// Finds a plant file: `model` as a path, or NAME/plant.toml among the plants that came with the product, which stand
/// in <folder of the program>/../share/armcmc/plants.
/// @throws ConfigError naming the places and the names that there are.
[[nodiscard]] std::filesystem::path FindPlantFile(const std::string& model);

/// Names of the plants that came with the product, sorted.
[[nodiscard]] std::vector<std::string> PlantNames();

}  // namespace armcmc::support
