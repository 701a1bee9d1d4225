#pragma once

#include "armcmc/effects/effect.hpp"
#include "plants/soft_actuator/effect_sizes.hpp"

namespace armcmc {

/// Stiffness that grows with the angle:  alpha'' -= stiffness alpha^3,  stiffness >= 0.
/// Acts on the bending angle, whose equation the estimator does not estimate: for offline fits only.
struct CubicStiffness {
  static constexpr EffectInfo kInfo{
      .name = "cubic_stiffness",
      .family = "stiffening",
      .formula = "alpha'' - stiffness alpha^3",
      .slot = EffectSlot::kAdditive,
      .online = false,
      .num_amplitudes = 1,
      .amplitudes = {{{"stiffness", "1/(s rad)^2", 0.0, 0.2, 0.0, 2.0, &actuator_unit::BendPerCubedAngle}}},
      .num_shapes = 0,
      .shapes = {},
  };
};

}  // namespace armcmc
