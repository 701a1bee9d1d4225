#pragma once

#include "armcmc/effects/effect.hpp"
#include "plants/soft_actuator/effect_sizes.hpp"
#include "plants/soft_actuator/flow_point.hpp"

namespace armcmc {

/// Valve that opens late and then faster:  u -> max(u - width, 0) / (1 - width),  0 <= width < 1.
struct ValveDeadBand {
  static constexpr double kWidest = 0.9;
  static constexpr EffectInfo kInfo{
      .name = "valve_dead_band",
      .family = "dead band",
      .formula = "u = max(u - width, 0) / (1 - width)",
      .slot = EffectSlot::kInputMap,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"width", "-", 0.0, 0.2, 0.0, 1.5, &actuator_unit::Opening}}},
      .num_shapes = 0,
      .shapes = {},
  };

  /// What is open of both valves beyond the width, with the sign of the opening.
  template <class S>
  static typename S::V Beyond(typename S::V opening, typename S::V width) noexcept {
    return S::Max(opening - width, typename S::V{}) + S::Min(opening + width, typename S::V{});
  }
  template <class S>
  static typename S::V Opening(typename S::V opening, typename S::V width) noexcept {
    return Beyond<S>(opening, width) / (S::Set(1.0) - S::Min(width, S::Set(kWidest)));
  }
  template <class S>
  static void Apply(typename S::V width, FlowPoint<S>* point) noexcept {
    point->opening = Opening<S>(point->opening, width);
  }
};

}  // namespace armcmc
