#pragma once

#include "armcmc/effects/effect.hpp"
#include "plants/soft_actuator/effect_sizes.hpp"

namespace armcmc {

/// Bouc and Wen's hysteresis of the bladder:  alpha'' -= acceleration z / reach,  z' = alpha' (1 - |z| / reach while
/// loading). Acts on the bending angle, whose equation the estimator does not estimate: for offline fits only.
struct Hysteresis {
  static constexpr EffectInfo kInfo{
      .name = "hysteresis",
      .family = "hysteresis",
      .formula = "alpha'' - acceleration z / reach, z' = alpha' (1 - |z| / reach while loading)",
      .slot = EffectSlot::kAdditive,
      .online = false,
      .num_amplitudes = 1,
      .amplitudes = {{{"acceleration", "rad/s^2", 0.0, 0.2, 0.0, 2.0, &actuator_unit::BendAcceleration}}},
      .num_shapes = 1,
      .shapes = {{{"reach", "rad", 0.05, &actuator_unit::Angle, 1e-9, 1e3}}},
  };
};

}  // namespace armcmc
