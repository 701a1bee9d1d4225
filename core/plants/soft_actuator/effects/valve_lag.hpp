#pragma once

#include "armcmc/effects/effect.hpp"

namespace armcmc {

/// Valves that follow their command late, as one spool:  tau s' + s = u_c - u_d,  open to the side of s's sign.
///
/// Exact for a command that holds over a sample:  s_n = e s_{n-1} + (1 - e) (u_c - u_d)_n,  e = exp(-dt / tau).
/// s starts at 0.
struct ValveLag {
  static constexpr EffectInfo kInfo{
      .name = "valve_lag",
      .family = "valve lag",
      .formula = "s, tau s' + s = u_c - u_d, open to the side of s's sign",
      .slot = EffectSlot::kInputMap,
      .online = true,
      .num_amplitudes = 1,
      .amplitudes = {{{"tau", "s", 0.0, 0.02, 0.0, 0.3, &effect_unit::One}}},
      .num_shapes = 0,
      .shapes = {},
  };

  template <class S>
  struct Spool {
    typename S::V keep;

    Spool(typename S::V tau, double dt) noexcept {
      constexpr double kLog2E = 1.44269504088896340736;
      // A time constant far below the sample interval is none: the quotient stays finite.
      keep = S::Exp2(S::Set(-kLog2E * dt) / S::Max(tau, S::Set(1e-3 * dt)));
    }
    typename S::V Next(typename S::V position, typename S::V command) const noexcept {
      return S::Fma(keep, position - command, command);
    }
  };
};

}  // namespace armcmc
