#pragma once

#include <cstdint>

#include "armcmc/nonblocking.hpp"

namespace armcmc::rt {

/// What the number of a pack says about it.
enum class SequenceVerdict : std::uint8_t {
  kFirst,      ///< First pack ever: use it.
  kNext,       ///< The next one, or a later one after a gap: use it.
  kRestart,    ///< First pack of a new run of the plant: use it.
  kDuplicate,  ///< Seen already: skip it.
  kReordered,  ///< Older than the newest, or of a run that is over: skip it.
};

/// Whether a pack with this verdict is to be used.
[[nodiscard]] constexpr bool IsUsable(SequenceVerdict verdict) noexcept {
  return verdict == SequenceVerdict::kFirst || verdict == SequenceVerdict::kNext ||
         verdict == SequenceVerdict::kRestart;
}

/// Watches pack numbers: gaps, duplicates, wrong order, restarts of the plant.
///
/// A restart is a new run_id. Two more signs count as one, so that a log played twice or a wild number
/// does not shut the estimator out: kRestartRun old packs in a row that count up by one, and a jump of
/// more than kMaxGap in either direction. A pack of the run before the present one is late, not a restart.
class SequenceTracker {
 public:
  /// A jump of more than this in either direction is a restart.
  static constexpr std::int64_t kMaxGap = 100'000;
  /// So many old packs in a row that count up by one are a restart.
  static constexpr int kRestartRun = 5;

  /// Totals since the start.
  struct Counts {
    std::int64_t lost = 0;       ///< Numbers that never came (one that comes late is taken off again).
    std::int64_t duplicate = 0;  ///< Numbers that came again.
    std::int64_t reordered = 0;  ///< Packs older than the newest one.
    std::int64_t restarts = 0;   ///< Runs after the first.
  };

  /// Verdict on one pack.
  struct Result {
    SequenceVerdict verdict = SequenceVerdict::kFirst;
    std::int64_t steps = 1;  ///< Pack numbers advanced since the newest, >= 1 for kNext.
  };

  /// Judges the next pack and updates the counts.
  /// @param seq     Number of the pack, >= 1.
  /// @param run_id  Run of the plant that sent it; another one starts a new count.
  /// @rt No heap, no lock, no throw. O(1).
  Result OnPack(std::int64_t seq, std::int64_t run_id) noexcept ARMCMC_NONBLOCKING;

  /// Notes the number of a pack that arrived but cannot be used, so that it is not counted as lost. Only a number
  /// shortly ahead in the same run is accepted, since the pack may be damaged elsewhere as well.
  /// @return Pack numbers advanced, 0 if it was not accepted. @rt O(1).
  std::int64_t OnUnusable(std::int64_t seq, std::int64_t run_id) noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }
  [[nodiscard]] std::int64_t newest() const noexcept { return newest_; }

 private:
  Result Restart(std::int64_t seq, std::int64_t run_id) noexcept ARMCMC_NONBLOCKING;
  Result Old(std::int64_t seq) noexcept ARMCMC_NONBLOCKING;

  static constexpr int kWindow = 64;

  Counts counts_;
  std::int64_t newest_ = 0;
  std::int64_t first_ = 0;  // of this run
  std::int64_t run_id_ = 0;
  std::int64_t previous_run_id_ = 0;
  std::uint64_t seen_ = 0;  // bit i: pack newest_ - i came
  std::int64_t last_old_ = 0;
  int old_in_a_row_ = 0;
  bool started_ = false;
  bool has_previous_run_ = false;
};

}  // namespace armcmc::rt
