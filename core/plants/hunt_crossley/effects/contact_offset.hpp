#pragma once

#include "armcmc/effects/effect.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"

namespace armcmc {

/// Surface that is not at x = 0:  x -> x - distance.
///
/// Contact then begins at x = distance; the depth enters the power law through log2, per candidate.
struct ContactOffset {
  static constexpr EffectInfo kInfo{
      .name = "contact_offset",
      .family = "contact offset",
      .formula = "x - distance in place of x",
      .slot = EffectSlot::kInputMap,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"distance", "m", 0.0, 0.1, -1.0, 1.0, &contact_unit::Length}}},
      .num_shapes = 0,
      .shapes = {},
  };

  /// log2 of the depth, and a value whose power underflows to zero where there is no contact.
  template <class S>
  static typename S::V Log2Depth(typename S::V x, typename S::V distance, typename S::V gate) noexcept {
    constexpr double kNoDepth = 1e-305;
    return S::Log2(S::Max(x - distance * gate, S::Set(kNoDepth)));
  }
};

}  // namespace armcmc
