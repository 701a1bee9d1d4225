#pragma once

#include "armcmc/effects/effect.hpp"

namespace armcmc {

/// First-order low pass of the force sensor:  time_constant g' + g = f,  g is what is measured,  time_constant >= 0.
///
/// Exact for f linear between samples: with e = exp(-dt / T), r = (1 - e) T / dt,
///   g_n = e g_{n-1} + (1 - r) f_n + (r - e) f_{n-1}.
struct SensorLag {
  static constexpr EffectInfo kInfo{
      .name = "sensor_lag",
      .family = "latency",
      .formula = "g, time_constant g' + g = f",
      .slot = EffectSlot::kSensorLag,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"time_constant", "s", 0.0, 0.02, 0.0, 0.06, &effect_unit::One}}},
      .num_shapes = 0,
      .shapes = {},
  };

  template <class S>
  struct Filter {
    typename S::V keep, now, before;

    Filter(typename S::V time_constant, double dt) noexcept {
      constexpr double kLog2E = 1.44269504088896340736;
      const auto one = S::Set(1.0);
      // A time constant far below the sample interval is none: the quotient stays finite.
      const auto ratio = S::Max(time_constant, S::Set(1e-6 * dt)) * S::Set(1.0 / dt);
      keep = S::Exp2(S::Set(-kLog2E) / ratio);
      const auto ramp = (one - keep) * ratio;
      now = one - ramp;
      before = ramp - keep;
    }
    typename S::V Next(typename S::V state, typename S::V f, typename S::V f_before) const noexcept {
      return S::Fma(keep, state, S::Fma(now, f, before * f_before));
    }
  };
};

}  // namespace armcmc
