#pragma once

#include "armcmc/effects/effect.hpp"
#include "plants/soft_actuator/effect_sizes.hpp"
#include "plants/soft_actuator/flow_point.hpp"

namespace armcmc {

/// Leak of the chamber to the atmosphere:  pdot -= rate (p - p_atm),  rate >= 0.
struct Leak {
  static constexpr EffectInfo kInfo{
      .name = "leak",
      .family = "leakage",
      .formula = "p' - rate (p - p_atm)",
      .slot = EffectSlot::kAdditive,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"rate", "1/s", 0.0, 0.2, 0.0, 2.0, &actuator_unit::FlowPerPressure}}},
      .num_shapes = 0,
      .shapes = {},
  };

  template <class S>
  static void Apply(typename S::V rate, FlowPoint<S>* point) noexcept {
    point->rate = point->rate - rate * point->gauge;
  }
};

}  // namespace armcmc
