#pragma once

namespace armcmc {

/// What the valve flow of the soft actuator is given at one sample, and what is added to it. The effects of its
/// catalogue change it one after the other, in the order of ActuatorEffects.
///
///   pdot = |opening| head / (g + theta2 gauge) + rate,   head = sign(dp) sqrt|dp|,
///   dp = supply - gauge while filling, gauge while venting
template <class S>
struct FlowPoint {
  typename S::V opening;  ///< Of the valves as one spool, u_c - u_d: fills where positive, vents where negative.
  typename S::V gauge;    ///< p - p_atm in the chamber, Pa.
  typename S::V supply;   ///< p_s - p_atm, Pa.
  typename S::V rate;     ///< Pa/s beside the valve flow's.
};

}  // namespace armcmc
