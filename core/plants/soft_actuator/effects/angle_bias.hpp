#pragma once

#include "armcmc/effects/effect.hpp"
#include "plants/soft_actuator/effect_sizes.hpp"

namespace armcmc {

/// Angle sensor with a zero of its own:  alpha + bias.
/// Acts on the bending angle, whose equation the estimator does not estimate: for offline fits only.
struct AngleBias {
  static constexpr EffectInfo kInfo{
      .name = "angle_bias",
      .family = "sensor zero",
      .formula = "alpha + bias",
      .slot = EffectSlot::kSensorStatics,
      .online = false,
      .num_amplitudes = 1,
      .amplitudes = {{{"bias", "rad", 0.0, 0.2, -2.0, 2.0, &actuator_unit::Angle}}},
      .num_shapes = 0,
      .shapes = {},
  };
};

}  // namespace armcmc
