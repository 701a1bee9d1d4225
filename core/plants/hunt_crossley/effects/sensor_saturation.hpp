#pragma once

#include "armcmc/effects/effect.hpp"
#include "plants/hunt_crossley/effect_sizes.hpp"

namespace armcmc {

/// Force sensor that clips:  f -> min(f, limit),  limit > 0.
struct SensorSaturation {
  static constexpr EffectInfo kInfo{
      .name = "sensor_saturation",
      .family = "saturation",
      .formula = "min(f, limit)",
      .slot = EffectSlot::kSensorStatics,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"limit", "N", 2.0, 1.0, 0.0, 10.0, &contact_unit::Force}}},
      .num_shapes = 0,
      .shapes = {},
  };

  template <class S>
  static typename S::V Clip(typename S::V force, typename S::V limit) noexcept {
    return S::Min(force, limit);
  }
};

}  // namespace armcmc
