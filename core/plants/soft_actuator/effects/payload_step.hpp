#pragma once

#include "armcmc/effects/effect.hpp"
#include "plants/soft_actuator/effect_sizes.hpp"

namespace armcmc {

/// Load that is picked up:  (1 + load) alpha'' in place of alpha'' from t = at on,  load >= 0.
/// Acts on the bending angle, whose equation the estimator does not estimate: for offline fits only.
struct PayloadStep {
  static constexpr EffectInfo kInfo{
      .name = "payload_step",
      .family = "payload",
      .formula = "(1 + load) alpha'' in place of alpha'' from t = at",
      .slot = EffectSlot::kConstitutiveLaw,
      .online = false,
      .num_amplitudes = 1,
      .amplitudes = {{{"load", "-", 0.0, 0.5, 0.0, 30.0, &effect_unit::One}}},
      .num_shapes = 1,
      .shapes = {{{"at", "s", 0.5, &actuator_unit::Duration, -1e12, 1e12}}},
  };
};

}  // namespace armcmc
