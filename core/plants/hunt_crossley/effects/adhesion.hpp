#pragma once

#include <cmath>

#include "armcmc/nonblocking.hpp"
#include "plants/hunt_crossley/effect_input.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"

namespace armcmc {

/// Tension while the surfaces separate:  f -= force exp(-x / distance)  for v < 0 and x >= 0,  force >= 0.
struct Adhesion {
  static constexpr EffectInfo kInfo{
      .name = "adhesion",
      .family = "adhesion",
      .formula = "f - force exp(-x / distance) [v < 0, x >= 0]",
      .slot = EffectSlot::kAdditive,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"force", "N", 0.0, 0.2, 0.0, 2.0, &contact_unit::Force}}},
      .num_shapes = 1,
      .shapes = {{{"distance", "m", 0.2, &contact_unit::Length, 1e-9, 1e3}}},
  };

  static void Feature(const EffectInput& in, const double* shape, double*,
                      double* feature) noexcept ARMCMC_NONBLOCKING {
    feature[0] = in.v < 0.0 && in.x >= 0.0 ? -std::exp(-in.x / shape[0]) : 0.0;
  }
};

}  // namespace armcmc
