#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "armcmc/plant/plant.hpp"
#include "armcmc/plant/program.hpp"
#include "armcmc/support/plant_effects.hpp"
#include "armcmc/support/strict_toml.hpp"

namespace armcmc::support {

/// A plant file with what it says of effects.
struct PlantFile {
  PlantDescription base;  ///< Without the effects that the file uses.
  Plant plant;            ///< With them.
  PlantEffects effects;
  std::vector<std::string> notes{};  ///< What may be a mistake, with its place.
};

/// Reads a plant file and understands it, effects that it uses included.
/// @throws ConfigError with file, line, column, key, and what was expected.
[[nodiscard]] Plant ReadPlant(const std::filesystem::path& path);
/// The same with its parts. @throws ConfigError.
[[nodiscard]] PlantFile ReadPlantFile(const std::filesystem::path& path);
/// ReadPlant, made ready for the estimator. @throws ConfigError also where the plant is more than it runs.
[[nodiscard]] std::shared_ptr<const PlantProgram> ReadPlantProgram(const std::filesystem::path& path);
/// ReadPlant from text; `name` stands for the file in messages.
[[nodiscard]] Plant PlantFromText(std::string_view text, std::string_view name);

}  // namespace armcmc::support
