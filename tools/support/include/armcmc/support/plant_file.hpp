#pragma once

#include <filesystem>
#include <string_view>

#include "armcmc/plant/plant.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::support {

/// Reads a plant file and understands it.
/// @throws ConfigError with file, line, column, key, and what was expected.
[[nodiscard]] Plant ReadPlant(const std::filesystem::path& path);
/// The same from text; `name` stands for the file in messages.
[[nodiscard]] Plant PlantFromText(std::string_view text, std::string_view name);

}  // namespace armcmc::support
