#pragma once

#include "armcmc/nonblocking.hpp"
#include "plants/hunt_crossley/effect_input.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"

namespace armcmc {

/// Viscous drag of the mechanism, in contact or not:  f += coefficient v,  coefficient >= 0.
struct ViscousFriction {
  static constexpr EffectInfo kInfo{
      .name = "viscous_friction",
      .family = "viscous friction",
      .formula = "f + coefficient v",
      .slot = EffectSlot::kAdditive,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"coefficient", "N s/m", 0.0, 0.2, 0.0, 2.0, &contact_unit::ForcePerSpeed}}},
      .num_shapes = 0,
      .shapes = {},
  };

  static void Feature(const EffectInput& in, const double*, double*, double* feature) noexcept ARMCMC_NONBLOCKING {
    feature[0] = in.v;
  }
};

}  // namespace armcmc
