#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "integration/live_pair.hpp"

namespace armcmc::test::faults_test {
namespace {

using namespace std::chrono_literals;

class Faults : public LivePair {};

TEST_F(Faults, BadPacksAreCountedByCauseAndNothingLearntIsLost) {
  auto estimator = StartEstimator();
  auto plant = StartPlant("3.6", {"--inject", "nan@20,size@22,duplicate@24,reorder@27,drop@30,foreign@32,garbage@34"});
  ASSERT_EQ(plant->Wait(60s).code, 0) << plant->err();
  ASSERT_TRUE(recorder_->WaitUntil([this] {
    const auto all = recorder_->estimates();
    return !all.empty() && all.back().seq == 36;
  })) << estimator->err();
  const estimator_status_t status = recorder_->statuses().back();
  const Json report = Finish(estimator.get());

  EXPECT_EQ(status.rejected_value, 1) << "nan";
  EXPECT_EQ(status.rejected_size + status.rejected_type, 3) << "size, foreign, garbage";
  EXPECT_EQ(status.packs_rejected, 4);
  EXPECT_EQ(status.packs_duplicate, 1);
  EXPECT_EQ(status.packs_reordered, 1);
  EXPECT_EQ(status.packs_lost, 1) << "drop; a rejected pack did arrive";
  EXPECT_EQ(report["packs"]["rejected"], 4);
  EXPECT_EQ(report["packs"]["duplicate"], 1);
  EXPECT_EQ(report["packs"]["reordered"], 1);
  EXPECT_EQ(report["packs"]["lost"], 1);
  EXPECT_EQ(report["misses"]["late_data"], 0);
  EXPECT_EQ(report["allocations"]["collect"], 0) << "bad packs do not allocate either";

  // The contact lasts until 3.9 s: from pack to pack the posterior only sharpens, whatever came between.
  // (The quartiles, not the sd: that holds the small probability of a change, which is far out.)
  double spread_before = 0.0;
  for (const estimate_t& estimate : recorder_->estimates()) {
    const double spread = estimate.q75[0] - estimate.q25[0];
    if (estimate.seq == 19) spread_before = spread;
    if (estimate.seq < 20) continue;
    EXPECT_EQ(estimate.known, 1);
    EXPECT_LE(spread, 1.2 * spread_before) << "pack " << estimate.seq;
  }
  EXPECT_GT(spread_before, 0.0);
}

}  // namespace
}  // namespace armcmc::test::faults_test
