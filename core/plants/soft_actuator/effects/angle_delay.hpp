#pragma once

#include "armcmc/effects/effect.hpp"

namespace armcmc {

/// Dead time of the angle sensor:  alpha(t - time),  time >= 0.
/// Acts on the bending angle, whose equation the estimator does not estimate: for offline fits only.
struct AngleDelay {
  static constexpr EffectInfo kInfo{
      .name = "sensor_delay",
      .family = "latency",
      .formula = "alpha(t - time)",
      .slot = EffectSlot::kSensorDelay,
      .online = false,
      .num_amplitudes = 1,
      .amplitudes = {{{"time", "s", 0.0, 0.02, 0.0, 0.05, &effect_unit::One}}},
      .num_shapes = 0,
      .shapes = {},
  };
};

}  // namespace armcmc
