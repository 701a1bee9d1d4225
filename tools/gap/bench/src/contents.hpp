#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace armcmc::gap_bench {

/// What a file holds; nothing where it cannot be read.
[[nodiscard]] inline std::string Contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace armcmc::gap_bench
