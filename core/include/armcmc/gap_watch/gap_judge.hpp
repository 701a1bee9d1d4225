#pragma once

#include <array>
#include <cstdint>

#include "armcmc/gap_watch/gap_block.hpp"
#include "armcmc/gap_watch/gap_checks.hpp"
#include "armcmc/gap_watch/gap_evidence.hpp"
#include "armcmc/gap_watch/gap_state.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc {

class SnapshotReader;
class SnapshotWriter;

/// Where a block of packs lies.
struct GapBlockSpan {
  std::int64_t first_seq = 0;  ///< Its first pack.
  std::int64_t now_seq = 0;    ///< The pack at which it is judged.
  double hours = 0.0;          ///< Data in it.
};

/// Turns the scores of successive blocks into what is published: evidence, the check with the most evidence, the alarm.
class GapJudge {
 public:
  /// @param checks  Outlive the judge. @param rate  See GapEvidence.
  GapJudge(const GapChecks& checks, double rate) noexcept : checks_(checks), evidence_(checks.size(), rate) {}

  /// One block whose checks were scored. @rt O(checks).
  void Add(const std::array<CheckScore, kMaxGapChecks>& scores, const GapBlock& block,
           const GapBlockSpan& span) noexcept ARMCMC_NONBLOCKING;
  /// @param watched  Of the state from now on.
  void Reset(bool watched) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] const GapState& state() const noexcept { return state_; }
  void Save(SnapshotWriter* out) const noexcept ARMCMC_NONBLOCKING;
  void Restore(SnapshotReader* in) noexcept ARMCMC_NONBLOCKING;

 private:
  const GapChecks& checks_;
  GapEvidence evidence_;
  GapState state_;
  std::array<double, kMaxGapChecks> explained_{};  ///< Of the last blocks.
  double excess_ = 0.0;
  std::array<std::int64_t, kMaxGapChecks> since_{};
};

}  // namespace armcmc
