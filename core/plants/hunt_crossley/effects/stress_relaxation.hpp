#pragma once

#include <cmath>

#include "armcmc/nonblocking.hpp"
#include "plants/hunt_crossley/effect_input.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"

namespace armcmc {

/// Maxwell branch in parallel with the contact:  f += stiffness (x+ - y),  time_constant y' + y = x+,  stiffness >= 0,
/// x+ = max(x, 0).
///
/// Exact for x+ linear between samples; the branch starts relaxed (y = x+).
struct StressRelaxation {
  static constexpr EffectInfo kInfo{
      .name = "stress_relaxation",
      .family = "viscoelastic memory",
      .formula = "f + stiffness (x+ - y), time_constant y' + y = x+",
      .slot = EffectSlot::kAdditive,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"stiffness", "N/m", 0.0, 0.2, 0.0, 4.0, &contact_unit::ForcePerLength}}},
      .num_shapes = 1,
      .shapes = {{{"time_constant", "s", 0.3, &effect_unit::One, 1e-6, 1e6}}},
  };

  static void Feature(const EffectInput& in, const double* shape, double* memory,
                      double* feature) noexcept ARMCMC_NONBLOCKING {
    const double depth = std::fmax(in.x, 0.0);
    // memory: depth of the sample before, and the force of the branch over its stiffness.
    if (in.first) {
      memory[1] = 0.0;
    } else {
      const double ratio = in.dt / shape[0];
      memory[1] = memory[1] * std::exp(-ratio) - (depth - memory[0]) * std::expm1(-ratio) / ratio;
    }
    memory[0] = depth;
    feature[0] = memory[1];
  }
};

}  // namespace armcmc
