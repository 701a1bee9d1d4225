#pragma once

#include <algorithm>
#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// A point of a periodic release grid.
struct Release {
  Nanos time_ns;         ///< CLOCK_MONOTONIC.
  std::uint32_t missed;  ///< Grid points that passed before it.
};

/// Next point of the release grid release + k period, k >= 1, after an iteration that ended at now_ns. Points that have
/// passed are skipped and counted, so that releases neither bunch nor drift.
/// @param release_ns  Point of the iteration that ended. @param now_ns  CLOCK_MONOTONIC. @param period_ns  > 0.
/// @rt No heap, no lock, no throw. O(1).
[[nodiscard]] constexpr Release NextRelease(Nanos release_ns, Nanos now_ns, Nanos period_ns) noexcept {
  const Nanos next = release_ns + period_ns;
  if (now_ns <= next) return {next, 0};
  const Nanos missed = (now_ns - release_ns) / period_ns;
  return {release_ns + (missed + 1) * period_ns, static_cast<std::uint32_t>(missed)};
}

/// The release grid of the estimator, locked to the cadence of the packs that the plant sends.
///
/// A pack is due at due(seq) = due(seq - 1) + T_s. It is released at the earlier of its due time and its
/// arrival, so a late pack does not get a later deadline: its lateness shows. The phase follows the plant:
///   - a pack that comes early moves the grid to its arrival;
///   - after kWindow packs that were all late, the grid moves by the least of those delays (a slower plant
///     clock, a plant that hesitated once and keeps the new phase);
///   - a pack that is late by a period or more after a pause proposes a new phase; the next one confirms it by keeping
///     to it, or refutes it by coming sooner: then the plant is catching up, and its packs are late on the old grid;
///   - for kSettleNs, at least kWindow packs, it may still be refuted by a pack that comes half a period early: while
///     the machine stutters, a plant that is catching up may pause between packs, and those are late on the old grid.
class ReleaseGrid {
 public:
  static constexpr int kWindow = 8;
  static constexpr Nanos kSettleNs = 100'000'000;  ///< As long as a machine may stutter.

  struct Point {
    Nanos release_ns = 0;   ///< min(due, arrival).
    Nanos lateness_ns = 0;  ///< max(0, arrival - due).
    /// While a new phase may still be refuted: how late the pack is on the grid that was left, if that was the right
    /// one.
    Nanos unsettled_ns = 0;
  };

  /// @param period_ns  T_s > 0.
  explicit ReleaseGrid(Nanos period_ns) noexcept
      : period_ns_(period_ns), settling_packs_(std::max<Nanos>(kWindow, kSettleNs / period_ns)) {}

  /// Locks the grid on the first pack of a run of the plant, which is on time by definition. @rt O(1).
  Point Lock(Nanos arrival_ns) noexcept ARMCMC_NONBLOCKING;

  /// Places the next pack on the grid.
  /// @param steps       Difference of its pack number to that of the pack before, >= 1.
  /// @param arrival_ns  When it came.
  /// @return its release and lateness.
  /// @pre locked(). @rt No heap, no lock, no throw. O(1).
  Point OnPack(std::int64_t steps, Nanos arrival_ns) noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] bool locked() const noexcept { return locked_; }
  [[nodiscard]] Nanos period_ns() const noexcept { return period_ns_; }
  /// When the pack after the newest one is due. @pre locked().
  [[nodiscard]] Nanos next_due_ns() const noexcept { return (proposed_ ? arrival_ns_ : due_ns_) + period_ns_; }

 private:
  void ClearWindow() noexcept ARMCMC_NONBLOCKING;

  Nanos period_ns_;
  std::int64_t settling_packs_;
  Nanos due_ns_ = 0;      // grid point of the newest pack
  Nanos arrival_ns_ = 0;  // of the newest pack
  Nanos window_min_ns_ = 0;
  int window_size_ = 0;
  Nanos left_due_ns_ = 0;        // the newest pack on the grid that was left for a new phase
  std::int64_t left_packs_ = 0;  // so many more may refute that phase
  bool locked_ = false;
  bool proposed_ = false;  // the newest pack came so late that its arrival may be the new phase
};

}  // namespace armcmc::rt
