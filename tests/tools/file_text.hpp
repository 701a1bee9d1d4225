#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace armcmc::test {

/// The bytes of a file; empty where there is none.
[[nodiscard]] inline std::string TextOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Whether a text has that part. Instead of a matcher, which would print a whole page.
[[nodiscard]] inline bool Holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace armcmc::test
