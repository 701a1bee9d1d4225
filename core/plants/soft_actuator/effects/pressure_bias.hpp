#pragma once

#include "armcmc/effects/effect.hpp"
#include "plants/soft_actuator/effect_sizes.hpp"
#include "plants/soft_actuator/flow_point.hpp"

namespace armcmc {

/// Pressure sensor with a zero of its own: what is measured is p + bias, so that the law is given the measured p less
/// bias.
struct PressureBias {
  static constexpr EffectInfo kInfo{
      .name = "pressure_bias",
      .family = "sensor zero",
      .formula = "p + bias",
      .slot = EffectSlot::kInputMap,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"bias", "Pa", 0.0, 0.2, -0.8, 0.8, &actuator_unit::Pressure}}},
      .num_shapes = 0,
      .shapes = {},
  };

  template <class S>
  static void Apply(typename S::V bias, FlowPoint<S>* point) noexcept {
    point->gauge = point->gauge - bias;
  }
};

}  // namespace armcmc
