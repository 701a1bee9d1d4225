#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/plant/effect.hpp"
#include "armcmc/support/plant_file.hpp"

namespace armcmc::model {

/// The plant with effects added to it, as words on the command line say (see support::RequestFromWord).
/// @param data  CSV whose columns are the plant's signals, for the sizes of priors; none: DefaultScales.
/// @throws ConfigError, InputError.
[[nodiscard]] PlantDescription Composed(const support::PlantFile& plant, const std::vector<std::string>& words,
                                        const std::optional<std::filesystem::path>& data);

/// Writes the composed plant as a plant file, and says what was added.
/// @throws InputError where `out` is there already or cannot be written.
[[nodiscard]] std::string AddToFile(const std::string& plant, const std::string& effect,
                                    const std::optional<std::filesystem::path>& data, const std::filesystem::path& out);

}  // namespace armcmc::model
