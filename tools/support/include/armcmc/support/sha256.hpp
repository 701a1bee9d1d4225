#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace armcmc::support {

/// SHA-256 (FIPS 180-4) of some bytes, as 64 lower-case hexadecimal digits.
[[nodiscard]] std::string Sha256(std::string_view bytes);
/// Of a file. @throws InputError where it cannot be read.
[[nodiscard]] std::string Sha256OfFile(const std::filesystem::path& path);

}  // namespace armcmc::support
