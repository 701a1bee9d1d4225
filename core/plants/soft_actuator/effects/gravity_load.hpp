#pragma once

#include "armcmc/effects/effect.hpp"
#include "plants/soft_actuator/effect_sizes.hpp"

namespace armcmc {

/// Weight at the tip:  alpha'' -= acceleration sin(alpha),  acceleration >= 0.
/// Acts on the bending angle, whose equation the estimator does not estimate: for offline fits only.
struct GravityLoad {
  static constexpr EffectInfo kInfo{
      .name = "gravity_load",
      .family = "gravity",
      .formula = "alpha'' - acceleration sin(alpha)",
      .slot = EffectSlot::kAdditive,
      .online = false,
      .num_amplitudes = 1,
      .amplitudes = {{{"acceleration", "rad/s^2", 0.0, 0.2, 0.0, 2.0, &actuator_unit::BendAcceleration}}},
      .num_shapes = 0,
      .shapes = {},
  };
};

}  // namespace armcmc
