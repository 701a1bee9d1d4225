#pragma once

#include <cmath>
#include <numbers>

#include "armcmc/nonblocking.hpp"
#include "plants/hunt_crossley/effect_input.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"

namespace armcmc {

/// Disturbance of known frequency, unknown amplitude and phase:  f += cosine cos(2 pi frequency t) + sine sin(2 pi
/// frequency t).
struct PeriodicDisturbance {
  static constexpr EffectInfo kInfo{
      .name = "periodic_disturbance",
      .family = "periodic disturbance",
      .formula = "f + cosine cos(2 pi frequency t) + sine sin(2 pi frequency t)",
      .slot = EffectSlot::kAdditive,
      .online = true,
      .num_amplitudes = 2,
      .amplitudes = {{{"cosine", "N", 0.0, 0.2, -2.0, 2.0, &contact_unit::Force},
                      {"sine", "N", 0.0, 0.2, -2.0, 2.0, &contact_unit::Force}}},
      .num_shapes = 1,
      .shapes = {{{"frequency", "Hz", 10.0, &effect_unit::One, 1e-6, 1e6}}},
  };

  static void Feature(const EffectInput& in, const double* shape, double*,
                      double* feature) noexcept ARMCMC_NONBLOCKING {
    const double phase = 2.0 * std::numbers::pi * shape[0] * in.t;
    feature[0] = std::cos(phase);
    feature[1] = std::sin(phase);
  }
};

}  // namespace armcmc
