#pragma once

#include "armcmc/nonblocking.hpp"
#include "plants/hunt_crossley/effect_input.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"

namespace armcmc {

/// Constant zero error of the force sensor:  f += force.  Felt out of contact too.
struct ForceBias {
  static constexpr EffectInfo kInfo{
      .name = "force_bias",
      .family = "sensor zero",
      .formula = "f + force",
      .slot = EffectSlot::kAdditive,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"force", "N", 0.0, 0.2, -2.0, 2.0, &contact_unit::Force}}},
      .num_shapes = 0,
      .shapes = {},
  };

  static void Feature(const EffectInput&, const double*, double*, double* feature) noexcept ARMCMC_NONBLOCKING {
    feature[0] = 1.0;
  }
};

}  // namespace armcmc
