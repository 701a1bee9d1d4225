#pragma once

#include "armcmc/effects/effect.hpp"
#include "plants/soft_actuator/effect_sizes.hpp"

namespace armcmc {

/// Disturbance of one frequency:  alpha'' += cosine cos(2 pi frequency t) + sine sin(2 pi frequency t).
/// Acts on the bending angle, whose equation the estimator does not estimate: for offline fits only.
struct AngleDisturbance {
  static constexpr EffectInfo kInfo{
      .name = "periodic_disturbance",
      .family = "periodic",
      .formula = "alpha'' + cosine cos(2 pi frequency t) + sine sin(2 pi frequency t)",
      .slot = EffectSlot::kAdditive,
      .online = false,
      .num_amplitudes = 2,
      .amplitudes = {{{"cosine", "rad/s^2", 0.0, 0.2, -2.0, 2.0, &actuator_unit::BendAcceleration},
                      {"sine", "rad/s^2", 0.0, 0.2, -2.0, 2.0, &actuator_unit::BendAcceleration}}},
      .num_shapes = 1,
      .shapes = {{{"frequency", "Hz", 1.0, &effect_unit::One, 1e-6, 1e6}}},
  };
};

}  // namespace armcmc
