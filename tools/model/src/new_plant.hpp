#pragma once

#include <filesystem>
#include <string>

namespace armcmc::model {

/// A plant file to start from: that of another plant under a new name, behind a comment that says what may stand in
/// one.
/// @throws support::InputError where the name is none; ConfigError where there is no such plant.
[[nodiscard]] std::string NewPlantText(const std::string& name, const std::filesystem::path& from);

}  // namespace armcmc::model
