#pragma once

#include "armcmc/effects/effect.hpp"

namespace armcmc {

/// Dead time of the force sensor:  f(t) -> f(t - time),  0 <= time, linear between samples.
struct SensorDelay {
  static constexpr EffectInfo kInfo{
      .name = "sensor_delay",
      .family = "latency",
      .formula = "f(t - time)",
      .slot = EffectSlot::kSensorDelay,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"time", "s", 0.0, 0.02, 0.0, 0.05, &effect_unit::One}}},
      .num_shapes = 0,
      .shapes = {},
  };

  /// Value of a series of vectors (series[n * kLanes + lane]) `lag` samples before sample n; the first sample holds
  /// before it.
  template <class S>
  static typename S::V Delayed(const double* series, int n, typename S::V lag) noexcept {
    using V = typename S::V;
    const V magic = S::Set(6755399441055744.0);  // 1.5 * 2^52
    const V position = S::Max(S::Set(n) - lag, V{});
    const V node = S::Max(S::Min((position - S::Set(0.5) + magic) - magic, S::Set(n > 0 ? n - 1 : 0)), V{});
    V lane{};
    for (int i = 0; i < S::kLanes; ++i) lane[i] = i;
    const typename S::I index = S::Bits(S::Fma(node, S::Set(S::kLanes), lane) + magic) - S::Bits(magic);
    const V low = S::Gather(series, index);
    const V high = n > 0 ? S::Gather(series + S::kLanes, index) : low;
    return S::Fma(position - node, high - low, low);
  }
};

}  // namespace armcmc
