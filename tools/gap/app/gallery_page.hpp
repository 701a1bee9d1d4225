#pragma once

#include <filesystem>

namespace armcmc::gap {

/// Writes index.html into a folder with reports in its subfolders, and links them in the order of their names.
/// @return The page.
/// @throws support::InputError where there is none, or a result.json that cannot be read.
std::filesystem::path WriteGallery(const std::filesystem::path& folder);

}  // namespace armcmc::gap
