#pragma once

#include <array>

#include "armcmc/effects/effect_rows.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

inline constexpr int kMaxAdditive = kMaxParams - 3;  ///< Amplitudes beside K, B, p.
inline constexpr int kMaxHistory = 256;              ///< Samples before a pack that its first forces may depend on.
inline constexpr int kMaxEffectSamples = kMaxHistory + kMaxPackSamples;

/// One pack of the contact with the inputs that its effects need, as the scoring kernels read it.
///
/// Rows run in time order: `history` samples of the packs before, then the pack. Amplitudes are rows of the ThetaTile;
/// a negative one says that the slot is empty.
struct alignas(64) ContactPack final : CompiledPack {
  using Row = std::array<double, kMaxEffectSamples>;

  int history = 0;
  int num_samples = 0;  ///< Of the pack.
  double dt = 0.0;      ///< s

  Row x{};  ///< m
  /// log2_x without contact: hugely negative, so that every power underflows to zero.
  static constexpr double kNoDepth = -1000.0;
  Row log2_x{};  ///< Of the depth, at least kNoDepth.
  Row v{};       ///< m/s

  int num_additive = 0;
  std::array<int, kMaxAdditive> additive_amplitude{};
  std::array<Row, kMaxAdditive> feature{};  ///< Force for an amplitude of one, gate included.

  int stiffness_rate = -1, contact_offset = -1, delay = -1, lag = -1, limit = -1;
  Row elapsed{};  ///< Time that stiffness_rate acts on, gate included; s.
  Row contact_offset_gate{}, delay_gate{}, lag_gate{}, limit_gate{};  ///< 0 or 1.

  [[nodiscard]] int rows() const noexcept { return history + num_samples; }
  /// Additive effects only: every force depends on its own sample.
  [[nodiscard]] bool additive_only() const noexcept {
    return stiffness_rate < 0 && contact_offset < 0 && delay < 0 && lag < 0 && limit < 0;
  }
};

}  // namespace armcmc
