#pragma once

#include <cstddef>

#include "armcmc/data_pack.hpp"
#include "armcmc/gap_watch/gap_checks.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc {

inline constexpr double kDeep = 0.75;     ///< Of the largest depth or angle: from here on it counts as large.
inline constexpr double kShallow = 0.25;  ///< Of the largest magnitude: up to here it counts as small.
inline constexpr double kHigh = 0.9;      ///< Of the largest output.
inline constexpr double kEarly = 0.25;    ///< s after a change of mode.

[[nodiscard]] inline std::size_t At(int i) noexcept ARMCMC_NONBLOCKING { return static_cast<std::size_t>(i); }
[[nodiscard]] inline double Sign(double v) noexcept ARMCMC_NONBLOCKING {
  return v > 0.0 ? 1.0 : (v < 0.0 ? -1.0 : 0.0);
}

/// Time since the last change of mode, carried from pack to pack; s.
[[nodiscard]] inline double TimeInMode(int mode, double dt, RegionMemory* memory) noexcept ARMCMC_NONBLOCKING {
  memory->in_mode_s = mode == memory->mode || memory->mode < 0 ? memory->in_mode_s + dt : 0.0;
  memory->mode = mode;
  return memory->in_mode_s;
}

/// Slope of one input over the pack: acceleration from a velocity that may be noisy.
[[nodiscard]] inline double MeanSlope(const DataPack& pack, std::size_t input) noexcept ARMCMC_NONBLOCKING {
  const int n = pack.num_samples;
  double sum = 0.0, square = 0.0;
  for (int i = 0; i < n; ++i) {
    const double s = i - 0.5 * (n - 1);
    sum += s * pack.u[static_cast<std::size_t>(i)][input];
    square += s * s;
  }
  return square > 0.0 ? sum / (square * pack.dt) : 0.0;
}

}  // namespace armcmc
