#pragma once

#include <array>

#include "armcmc/gap_watch/gap_checks.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc {

class SnapshotReader;
class SnapshotWriter;

/// One check of one block.
struct CheckScore {
  double z = 0.0;       ///< Self-normalised score: conditionally sub-Gaussian with variance 1 when there is no gap.
  double margin = 0.0;  ///< What a tolerated misfit may add to |z|.
};

/// Anytime-valid evidence for a gap from the scores of successive blocks.
///
/// A bet of size l on sign s multiplies the capital by exp(l (s z - margin) - l^2 / 2), whose conditional expectation
/// is at most 1 without a gap (sub-Gaussian z). For each check, sign and size in {1, 2, 3} the capital is
///
///   C <- (C + w) exp(l (s z - margin) - l^2 / 2)
///
/// where w is new stake, put in before every block, so that a gap which begins late is found as if the watch had begun
/// with it. The total capital minus the stakes is a supermartingale: by Doob's inequality the probability that the
/// total ever reaches 1 before the stakes sum to W is at most W. Stakes are rate / 2 for the first block and rate / 2
/// for each hour of data, split evenly over all bets. The e-value is total capital over stakes; its threshold is 1 /
/// stakes.
class GapEvidence {
 public:
  /// @param rate  Bound on the probability of a false alarm in the first hour, in (0, 1).
  GapEvidence(int num_checks, double rate) noexcept : num_checks_(num_checks), rate_(rate) {}

  /// One block. @rt bounded. @param hours  Data in the block.
  void Add(const std::array<CheckScore, kMaxGapChecks>& scores, double hours) noexcept ARMCMC_NONBLOCKING;
  void Reset() noexcept ARMCMC_NONBLOCKING;
  void Save(SnapshotWriter* out) const noexcept ARMCMC_NONBLOCKING;
  void Restore(SnapshotReader* in) noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] double total() const noexcept ARMCMC_NONBLOCKING;  ///< Capital; 1 is the alarm.
  [[nodiscard]] double stakes() const noexcept { return stakes_; }
  [[nodiscard]] double of(int check) const noexcept ARMCMC_NONBLOCKING;  ///< Capital of one check.

 private:
  static constexpr std::array<double, 3> kSizes{1.0, 2.0, 3.0};
  static constexpr double kMostCapital = 1e200;  ///< Of one bet: the sum stays finite.
  using Bets = std::array<double, 2 * kSizes.size()>;

  int num_checks_;
  double rate_;
  double stakes_ = 0.0;
  std::array<Bets, kMaxGapChecks> capital_{};
};

}  // namespace armcmc
