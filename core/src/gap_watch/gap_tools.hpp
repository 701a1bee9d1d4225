#pragma once

#include <cstddef>

#include "armcmc/nonblocking.hpp"

namespace armcmc {

inline constexpr double kDeep = 0.75;  ///< Of the largest depth or angle: from here on it counts as large.

[[nodiscard]] inline std::size_t At(int i) noexcept ARMCMC_NONBLOCKING { return static_cast<std::size_t>(i); }
[[nodiscard]] inline double Sign(double v) noexcept ARMCMC_NONBLOCKING {
  return v > 0.0 ? 1.0 : (v < 0.0 ? -1.0 : 0.0);
}

}  // namespace armcmc
