#pragma once

#include <cstdint>

#include "armcmc/nonblocking.hpp"

namespace armcmc {

inline constexpr int kMaxParams = 8;         ///< Sampled parameters of one mode, noise scale included.
inline constexpr int kMaxReported = 8;       ///< Reported quantities of one mode: parameters and derived ones.
inline constexpr int kMaxModes = 4;          ///< Modes of a hybrid plant.
inline constexpr int kMaxPackSamples = 256;  ///< Samples in one pack.
inline constexpr int kMaxPackInputs = 8;     ///< Measured inputs in one pack.
inline constexpr int kMaxDraws = 150'000;    ///< Upper end of the configurable number of draws.
inline constexpr int kHistogramBins = 64;    ///< Bins of a published marginal.

using Nanos = std::int64_t;  ///< Time in nanoseconds; the caller chooses the clock.

/// The clock of a step, handed in by the caller: core never asks the operating system for the time.
/// A default-constructed clock always reads 0, so that no deadline is ever reached (replay).
struct ClockRef {
  Nanos (*read)(const void* context) noexcept ARMCMC_NONBLOCKING = nullptr;
  const void* context = nullptr;
  [[nodiscard]] Nanos Now() const noexcept { return read != nullptr ? read(context) : 0; }
};

}  // namespace armcmc
