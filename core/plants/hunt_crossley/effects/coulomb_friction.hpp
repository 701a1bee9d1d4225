#pragma once

#include <cmath>

#include "armcmc/nonblocking.hpp"
#include "plants/hunt_crossley/effect_input.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"

namespace armcmc {

/// Dry friction of the mechanism, smooth through standstill:  f += force tanh(v / speed),  force >= 0.
struct CoulombFriction {
  static constexpr EffectInfo kInfo{
      .name = "coulomb_friction",
      .family = "dry friction",
      .formula = "f + force tanh(v / speed)",
      .slot = EffectSlot::kAdditive,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"force", "N", 0.0, 0.2, 0.0, 2.0, &contact_unit::Force}}},
      .num_shapes = 1,
      .shapes = {{{"speed", "m/s", 0.02, &contact_unit::Speed, 1e-9, 1e3}}},
  };

  static void Feature(const EffectInput& in, const double* shape, double*,
                      double* feature) noexcept ARMCMC_NONBLOCKING {
    feature[0] = std::tanh(in.v / shape[0]);
  }
};

}  // namespace armcmc
