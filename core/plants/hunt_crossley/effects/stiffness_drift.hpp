#pragma once

#include "armcmc/nonblocking.hpp"
#include "plants/hunt_crossley/effect_input.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"

namespace armcmc {

/// Stiffness that changes slowly with time (heat, fatigue):  K -> K (1 + rate (t - origin)),  never below zero.
struct StiffnessDrift {
  static constexpr EffectInfo kInfo{
      .name = "stiffness_drift",
      .family = "stiffness drift",
      .formula = "K (1 + rate (t - origin)) in place of K",
      .slot = EffectSlot::kConstitutiveLaw,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"rate", "1/s", 0.0, 0.2, -0.9, 2.0, &contact_unit::PerTime}}},
      .num_shapes = 1,
      .shapes = {{{"origin", "s", 0.0, &effect_unit::One, -1e12, 1e12}}},
  };

  /// t - origin, the factor of the rate; s.
  static double Elapsed(const EffectInput& in, const double* shape) noexcept ARMCMC_NONBLOCKING {
    return in.t - shape[0];
  }

  template <class S>
  static typename S::V Stiffness(typename S::V stiffness, typename S::V rate, typename S::V elapsed) noexcept {
    return stiffness * S::Max(S::Fma(rate, elapsed, S::Set(1.0)), typename S::V{});
  }
};

}  // namespace armcmc
