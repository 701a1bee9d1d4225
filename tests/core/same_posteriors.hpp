#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "core/estimator_rig.hpp"

namespace armcmc::test {

/// `to` goes on from where `from` is.
inline void GoOnFrom(const Rig& from, Rig* to) {
  std::vector<std::byte> adjusted(Estimator::kSnapshotBytes), executed(Estimator::kSnapshotBytes);
  adjusted.resize(from.estimator.SaveAdjusted(adjusted));
  executed.resize(from.estimator.SaveExecuted(executed));
  ASSERT_TRUE(to->estimator.Restore(adjusted, executed));
}

/// Runs packs with sums over the samples and sample by sample, each from the same memory. A candidate that falls to
/// another component of the proposal by the last digits changes a mean by some 1e-4 standard deviations.
/// @param tolerance  In standard deviations.
inline void ExpectSamePosteriors(EstimatorSettings settings, const std::vector<DataPack>& packs,
                                 double tolerance = 2e-3) {
  Rig sums(settings);
  settings.sampler.use_linearity = false;
  Rig samples(settings);
  for (const DataPack& pack : packs) {
    const Estimate& by_sums = sums.Step(pack);
    const Estimate& by_samples = samples.Step(pack);
    for (std::size_t m = 0; m < kMaxModes; ++m) {
      const ModeEstimate& a = by_sums.modes[m];
      const ModeEstimate& b = by_samples.modes[m];
      ASSERT_EQ(a.updated, b.updated);
      if (!b.updated) continue;
      EXPECT_EQ(a.draws, b.draws);
      EXPECT_EQ(a.decision, b.decision);
      EXPECT_NEAR(a.log_evidence, b.log_evidence, tolerance) << pack.seq;
      EXPECT_NEAR(a.kish_ess, b.kish_ess, tolerance * b.kish_ess) << pack.seq;
      for (std::size_t d = 0; d < static_cast<std::size_t>(settings.num_parameters); ++d) {
        EXPECT_NEAR(a.marginal[d].ar_ap, b.marginal[d].ar_ap, tolerance * b.marginal[d].sd) << pack.seq << ' ' << d;
        EXPECT_NEAR(a.marginal[d].is_sd, b.marginal[d].is_sd, tolerance * b.marginal[d].is_sd) << pack.seq << ' ' << d;
      }
    }
    GoOnFrom(samples, &sums);
  }
}

}  // namespace armcmc::test
