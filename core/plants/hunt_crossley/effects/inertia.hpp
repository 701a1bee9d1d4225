#pragma once

#include "armcmc/nonblocking.hpp"
#include "plants/hunt_crossley/effect_input.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"

namespace armcmc {

/// Mass between sensor and contact:  f += mass dv/dt,  mass >= 0.
///
/// dv/dt is the backward difference of v through a first-order low pass of time constant `smoothing` (0: none), which
/// trades noise of a measured v against lag.
struct Inertia {
  static constexpr EffectInfo kInfo{
      .name = "inertia",
      .family = "inertia",
      .formula = "f + mass dv/dt",
      .slot = EffectSlot::kAdditive,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"mass", "kg", 0.0, 0.2, 0.0, 2.0, &contact_unit::ForcePerAcceleration}}},
      .num_shapes = 1,
      .shapes = {{{"smoothing", "s", 0.0, &effect_unit::One, 0.0, 1.0}}},
  };

  static void Feature(const EffectInput& in, const double* shape, double* memory,
                      double* feature) noexcept ARMCMC_NONBLOCKING {
    const double raw = in.first ? 0.0 : (in.v - memory[0]) / in.dt;
    memory[0] = in.v;
    memory[1] = in.first ? 0.0 : memory[1] + (raw - memory[1]) * in.dt / (in.dt + shape[0]);
    feature[0] = memory[1];
  }
};

}  // namespace armcmc
