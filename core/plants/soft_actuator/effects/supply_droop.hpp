#pragma once

#include "armcmc/effects/effect.hpp"
#include "plants/soft_actuator/effect_sizes.hpp"
#include "plants/soft_actuator/flow_point.hpp"

namespace armcmc {

/// Supply pressure that falls while the fill valve is open:  p_s -> p_s - droop u_c,  droop >= 0.
struct SupplyDroop {
  static constexpr EffectInfo kInfo{
      .name = "supply_droop",
      .family = "supply",
      .formula = "p_s - droop u_c in place of p_s",
      .slot = EffectSlot::kConstitutiveLaw,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"droop", "Pa", 0.0, 0.2, 0.0, 1.0, &actuator_unit::SupplyPerOpening}}},
      .num_shapes = 0,
      .shapes = {},
  };

  template <class S>
  static typename S::V Supply(typename S::V supply, typename S::V droop, typename S::V opening) noexcept {
    return supply - droop * S::Max(opening, typename S::V{});
  }
  template <class S>
  static void Apply(typename S::V droop, FlowPoint<S>* point) noexcept {
    point->supply = Supply<S>(point->supply, droop, point->opening);
  }
};

}  // namespace armcmc
