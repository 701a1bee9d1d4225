// Packs of 10 ms: the motion hardly moves within one, so that a pack alone leaves a thin, bent sheet of parameters. A
// posterior that is found by too few candidates would be narrow, wrong, and believed.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "support/packs.hpp"

namespace armcmc::short_packs_test {
namespace {

constexpr int kCycle = 49, kStable = 41;  // packs: of a cycle, and of them those before the plant is another
const test::ContactTruth kFirm, kSoft{.k = 2.0, .b = 1.15, .p = 1.7};

struct Record {
  int modifications = 0, thin = 0;  // thin: fewer than 100 effective candidates
  double lowest_ess = 1e9, lowest_sd = 1e9;
};

/// Runs `cycles` of both plants. @param mixed  Samples of the first pack of a plant that are still of the other.
Record RunCycles(int cycles, int mixed) {
  Estimator estimator(BuiltinSettings("hunt_crossley"));
  const auto result = estimator.MakeResult();
  const auto estimate = std::make_unique<Estimate>();
  test::Normal normal(11);
  Record record;
  bool was_soft = false;
  for (int k = 1; k <= cycles * kCycle; ++k) {
    const bool soft = k % kCycle >= kStable;
    const test::Motion motion{.depth = 1.6, .swing = 1.4, .hertz = 0.66, .phase = 0.0};
    test::Normal noise = normal;
    DataPack pack = test::MakeContactPack(k, motion, soft ? kSoft : kFirm, 0.1, &normal, 100, 1e-4);
    const bool jumps = k > 1 && soft != was_soft;
    if (jumps) {
      const DataPack before = test::MakeContactPack(k, motion, was_soft ? kSoft : kFirm, 0.1, &noise, 100, 1e-4);
      for (std::size_t n = 0; n < static_cast<std::size_t>(mixed); ++n) pack.y[n] = before.y[n];
    }
    was_soft = soft;
    EXPECT_EQ(estimator.Adjust(pack, 0, {}, result.get()), Status::kOk);
    estimator.Execute(*result, estimate.get());
    const ModeEstimate& e = estimate->modes[0];
    if (e.decision == Decision::kModification) {
      ++record.modifications;
      record.thin += e.kish_ess < 100.0 ? 1 : 0;
      record.lowest_ess = std::fmin(record.lowest_ess, e.kish_ess);
    }
    for (std::size_t i = 0; i < 3; ++i) record.lowest_sd = std::fmin(record.lowest_sd, e.marginal[i].sd);
  }
  return record;
}

TEST(ShortPacks, AChangeOfSeveralParametersIsSampledByManyCandidates) {
  const Record record = RunCycles(20, 0);
  EXPECT_GE(record.modifications, 20);
  EXPECT_LE(record.thin, record.modifications / 20) << "fewest effective candidates: " << record.lowest_ess;
  EXPECT_GT(record.lowest_sd, 1e-6);
}

TEST(ShortPacks, APackOfTwoPlantsIsSampledAtTheEdgeOfTheBounds) {
  const Record record = RunCycles(20, 50);
  EXPECT_GE(record.modifications, 20);
  EXPECT_LE(record.thin, record.modifications / 10) << "fewest effective candidates: " << record.lowest_ess;
}

}  // namespace
}  // namespace armcmc::short_packs_test
