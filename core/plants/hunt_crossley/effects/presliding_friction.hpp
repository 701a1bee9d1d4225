#pragma once

#include <cmath>

#include "armcmc/nonblocking.hpp"
#include "plants/hunt_crossley/effect_input.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"

namespace armcmc {

/// Dry friction that builds up over a distance (Dahl):  f += force z,  dz/dx = (1 - z sign v) / distance,  force >= 0.
///
/// Exact for a speed that keeps its sign over a sample: z relaxes towards sign(v) by exp(-|v| dt / distance). z starts
/// at 0.
struct PreslidingFriction {
  static constexpr EffectInfo kInfo{
      .name = "presliding_friction",
      .family = "dry friction",
      .formula = "f + force z, dz/dx = (1 - z sign v) / distance",
      .slot = EffectSlot::kAdditive,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"force", "N", 0.0, 0.2, 0.0, 2.0, &contact_unit::Force}}},
      .num_shapes = 1,
      .shapes = {{{"distance", "m", 0.05, &contact_unit::Length, 1e-9, 1e3}}},
  };

  static void Feature(const EffectInput& in, const double* shape, double* memory,
                      double* feature) noexcept ARMCMC_NONBLOCKING {
    if (in.first) {
      memory[0] = 0.0;
    } else {
      const double direction = in.v > 0.0 ? 1.0 : (in.v < 0.0 ? -1.0 : memory[0]);
      memory[0] = direction + (memory[0] - direction) * std::exp(-std::fabs(in.v) * in.dt / shape[0]);
    }
    feature[0] = memory[0];
  }
};

}  // namespace armcmc
