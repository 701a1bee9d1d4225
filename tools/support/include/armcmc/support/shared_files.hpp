#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace armcmc::support {

/// <folder of the program>/../share/armcmc/<kind>, in an installed tree as in a build tree, so that programs find their
/// files from any folder and after being moved.
[[nodiscard]] std::filesystem::path SharedFolder(const std::string& kind);

/// Makes SharedFolder() <prefix>/share/armcmc/<kind>, for code whose process is not a program of this project: a Python
/// interpreter. Set-up only: before other threads look for files. An empty path takes it back.
void UseSharedPrefix(const std::filesystem::path& prefix);

/// Finds a file that came with the product: a configuration or a scenario.
///
/// In this order: `name` as a path; `name` with ".toml"; the same in the shared folder.
/// @param kind  "config" or "scenarios".
/// @throws ConfigError naming the places and the names that there are.
[[nodiscard]] std::filesystem::path FindSharedFile(const std::string& kind, const std::string& name);

/// Names (without ".toml") of the shared files of a kind, sorted. Empty when there is no such folder.
[[nodiscard]] std::vector<std::string> SharedFileNames(const std::string& kind);

}  // namespace armcmc::support
