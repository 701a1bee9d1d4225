#pragma once

#include "armcmc/effects/flow_point.hpp"
#include "armcmc/effects/registry.hpp"

namespace armcmc {

/// The valve flow with its effects (see FlowPoint), for the arithmetic S.
template <class S>
struct FlowLaw {
  using V = typename S::V;

  /// An effect that acts on its sample; the spool of ValveLag is moved by whoever keeps its position.
  template <class E>
  static constexpr bool kActs = requires(V amplitude, FlowPoint<S>* point) {
    E::template Apply<S>(amplitude, point);
  };

  /// sign(dp) sqrt|dp| of the valve that `mode` opens; sqrt(Pa).
  static V Head(const FlowPoint<S>& point, int mode) noexcept {
    const V dp = mode == 0 ? point.supply - point.gauge : point.gauge;
    return S::CopySign(S::Sqrt(S::Abs(dp)), dp);
  }

  /// Opening of the valve of `mode`, >= 0.
  static V Opening(const FlowPoint<S>& point, int mode) noexcept {
    return S::Max(mode == 0 ? point.opening : V{} - point.opening, V{});
  }

  /// What is compared with the measured pdot, Pa/s:
  ///
  ///   pdot + sigma (opening head - (pdot - rate) gain) / max(|gain|, least_gain),   gain = g + theta2 gauge
  ///
  /// with sigma = 1 for the fill valve and -1 for the vent valve. For a gain of the sign that its valve must have this
  /// is the predicted pressure rate, opening head / gain + rate; near and beyond gain = 0, where that has a pole, it is
  /// what leads a fit away from there.
  static V Rate(const FlowPoint<S>& point, int mode, V g, V theta2, V pdot, V least_gain) noexcept {
    const V gain = S::Fma(theta2, point.gauge, g);
    const V flow = S::Fma(V{} - (pdot - point.rate), gain, Opening(point, mode) * Head(point, mode));
    const V off = flow / S::Max(S::Abs(gain), least_gain);
    return mode == 0 ? pdot + off : pdot - off;
  }
};

}  // namespace armcmc
