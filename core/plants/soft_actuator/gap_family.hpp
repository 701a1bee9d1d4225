#pragma once

#include <cstdint>

#include "armcmc/gap_watch/gap_checks.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// What the gap watch looks for in the errors of the valve flow.
[[nodiscard]] const GapFamily& ActuatorGapFamily() noexcept;

/// Regions of the bend equation, in the order of BendChecks().
enum BendRegion : std::uint8_t {
  kBending,
  kBendDirection,
  kBendSpeed,
  kBendAngle,
  kBendLargeAngle,
  kBendAcceleration,
  kNumBendRegions
};
/// The checks of the bend equation; their indices follow those of the valve flow.
[[nodiscard]] const GapChecks& BendChecks() noexcept ARMCMC_NONBLOCKING;

}  // namespace armcmc
