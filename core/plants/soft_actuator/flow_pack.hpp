#pragma once

#include <array>
#include <cstdint>

#include "armcmc/effects/effect_rows.hpp"
#include "armcmc/types.hpp"
#include "plants/soft_actuator/effects.hpp"

namespace armcmc {

inline constexpr int kMaxFlowHistory = 256;  ///< Samples before a pack whose commands a slow valve still follows.

/// One pack of the soft actuator with the inputs that the effects of its valve flow need, as the scoring kernels read
/// it. Amplitudes are rows of the ThetaTile; a negative one says that the effect is not there.
struct alignas(64) FlowPack final : CompiledPack {
  using Row = std::array<double, kMaxPackSamples>;

  int num_samples = 0;
  double dt = 0.0;          ///< s
  double supply = 0.0;      ///< p_s - p_atm, Pa.
  double least_gain = 0.0;  ///< Size of g + theta2 (p - p_atm) below which a valve passes nonsense; sqrt(Pa) s/Pa.
  Row gauge{};              ///< p - p_atm as measured, Pa.
  Row pdot{};               ///< Pa/s
  bool head_moves = false;  ///< Some effect changes the pressures across the valves: `head` is not theirs.
  Row head{};  ///< sign(dp) sqrt|dp| by the measured pressure, of the valve that is commanded to open; sqrt(Pa).

  std::array<int, FlowEffects::kSize> amplitude{};
  std::array<Row, FlowEffects::kSize> gate{};  ///< 0 or 1.

  int history = 0;     ///< Commands of the packs before.
  double spool = 0.0;  ///< Where the spool stood before the first command, at the typical time constant.
  std::array<double, kMaxFlowHistory + kMaxPackSamples> command{};  ///< u_c - u_d, in time order.

  /// Valve whose parameters a sample speaks of; as many as there are modes: none.
  std::array<std::int8_t, kMaxPackSamples> mode{};
};

}  // namespace armcmc
