#pragma once

#include "plants/soft_actuator/effects.hpp"
#include "plants/soft_actuator/flow_point.hpp"

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

  /// The predicted pressure rate of the valve of `mode`, Pa/s, for gain = g + theta2 gauge of the sign that the valve
  /// must have and at least `least_gain` large:
  ///
  ///   opening head / gain + rate
  ///
  /// Towards gain = 0, where that has a pole, the error pdot - prediction goes on as a straight line in gain that leads
  /// a fit out to where opening head = (pdot - rate) gain; where hardly anything passes, as a constant: an explanation
  /// by a gain of zero is none.
  /// @param head  Head(point, mode), or what is known of it beforehand.
  /// @param pdot  As measured; the prediction depends on it for gains that are too small only.
  static V Rate(const FlowPoint<S>& point, int mode, V head, V g, V theta2, V pdot, V least_gain) noexcept {
    constexpr double kLeastFlows = 4.0;  // times what the least gain would need: then the line misses zero by as much
    const V gain = S::Fma(theta2, point.gauge, g);
    const V flow = Opening(point, mode) * head;
    const V wanted = pdot - point.rate;
    const V large = S::Max(S::Abs(gain) - least_gain, S::Abs(flow) - S::Set(kLeastFlows) * least_gain * S::Abs(wanted));
    const V held = S::Select(large >= V{}, gain, mode == 0 ? least_gain : V{} - least_gain);
    const V off = S::Fma(V{} - wanted, held, flow) / S::Max(S::Abs(gain), least_gain);
    return mode == 0 ? pdot + off : pdot - off;
  }
};

}  // namespace armcmc
