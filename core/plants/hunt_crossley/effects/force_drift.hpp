#pragma once

#include "armcmc/nonblocking.hpp"
#include "plants/hunt_crossley/effect_input.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"

namespace armcmc {

/// Zero of the force sensor that wanders linearly:  f += rate (t - origin).
struct ForceDrift {
  static constexpr EffectInfo kInfo{
      .name = "force_drift",
      .family = "sensor zero",
      .formula = "f + rate (t - origin)",
      .slot = EffectSlot::kAdditive,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"rate", "N/s", 0.0, 0.2, -2.0, 2.0, &contact_unit::ForcePerTime}}},
      .num_shapes = 1,
      .shapes = {{{"origin", "s", 0.0, &effect_unit::One, -1e12, 1e12}}},
  };

  static void Feature(const EffectInput& in, const double* shape, double*,
                      double* feature) noexcept ARMCMC_NONBLOCKING {
    feature[0] = in.t - shape[0];
  }
};

}  // namespace armcmc
