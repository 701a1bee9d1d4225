#pragma once

#include <string>
#include <string_view>

namespace armcmc::plant_sim {

/// SHA-256 (FIPS 180-4) of some bytes, as 64 lower-case hexadecimal digits.
[[nodiscard]] std::string Sha256(std::string_view bytes);

}  // namespace armcmc::plant_sim
