#pragma once

#include <array>
#include <cstddef>

#include "armcmc/expression/tape.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

inline constexpr int kMaxStates = 8;           ///< States of a plant.
inline constexpr int kMaxStateCells = 65'536;  ///< Numbers that the rates of one pack need: rows x scalars.

/// Numbers of kTileLanes candidates: value[state][lane].
struct alignas(64) StateTile {
  std::array<std::array<double, kTileLanes>, kMaxStates> value;
};

/// The states of a described plant over the samples of one pack, as every candidate integrates them: the tape `step`
/// advances them by a substep h with the classical Runge-Kutta method,
///
///     x(t + h) = x + h/6 (k1 + 2 k2 + 2 k3 + k4),   k1 = f(x, t), k2 = f(x + h/2 k1, t + h/2),
///     k3 = f(x + h/2 k2, t + h/2), k4 = f(x + h k3, t + h),
///
/// `substeps` times per sample interval, with inputs interpolated between samples as the plant says (Between). A row
/// holds the scalars of one substep; the rows of a pack are contiguous.
struct StateRun {
  const expression::Tape* step = nullptr;   ///< Null: the plant has no states.
  const expression::Tape* start = nullptr;  ///< State at the first sample, of the scalars of that sample.
  int num_states = 0;                       ///< At most kMaxStates.
  int num_samples = 0;                      ///< Samples of the pack.
  int substeps = 1;                         ///< Integration steps per sample interval.
  bool carried = false;  ///< Continues from `value`, one interval before the first sample; else begins at that sample.
  /// Whether a state begins with a number, and that number.
  std::array<bool, kMaxStates> given{};
  std::array<double, kMaxStates> value{};
  int stride = 0;  ///< Scalars of a row.
  alignas(64) std::array<double, kMaxStateCells> cell;

  /// Scalars of row r, `stride` of them. @pre r >= 0, (r + 1) stride <= kMaxStateCells.
  [[nodiscard]] const double* Row(int r) const noexcept {
    return cell.data() + static_cast<std::ptrdiff_t>(r) * stride;
  }
  [[nodiscard]] double* Row(int r) noexcept { return cell.data() + static_cast<std::ptrdiff_t>(r) * stride; }
};

}  // namespace armcmc
