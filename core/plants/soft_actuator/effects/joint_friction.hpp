#pragma once

#include "armcmc/effects/effect.hpp"
#include "plants/soft_actuator/effect_sizes.hpp"

namespace armcmc {

/// Dry friction of the joint:  alpha'' -= acceleration tanh(alpha' / rate_s),  acceleration >= 0.
/// Acts on the bending angle, whose equation the estimator does not estimate: for offline fits only.
struct JointFriction {
  static constexpr EffectInfo kInfo{
      .name = "joint_friction",
      .family = "dry friction",
      .formula = "alpha'' - acceleration tanh(alpha' / rate_s)",
      .slot = EffectSlot::kAdditive,
      .online = false,
      .num_amplitudes = 1,
      .amplitudes = {{{"acceleration", "rad/s^2", 0.0, 0.2, 0.0, 2.0, &actuator_unit::BendAcceleration}}},
      .num_shapes = 1,
      .shapes = {{{"rate_s", "rad/s", 0.02, &actuator_unit::AngleRate, 1e-9, 1e3}}},
  };
};

}  // namespace armcmc
