#include "armcmc/rt/adjust_stage.hpp"

#include <gtest/gtest.h>

#include "armcmc/estimator_status_t.hpp"
#include "stage_rig.hpp"

namespace armcmc::rt::adjust_stage_test {
namespace {

using test::kHour;

TEST(AdjustDeadline, LeavesTheReserveUnlessTheDeadlineIsLostAnyway) {
  EXPECT_EQ(AdjustDeadline(/*start=*/0, /*deadline=*/100, /*budget=*/50, /*reserve=*/20), 50);
  EXPECT_EQ(AdjustDeadline(40, 100, 50, 20), 80);
  EXPECT_EQ(AdjustDeadline(80, 100, 50, 20), 130) << "lost: the whole budget, for the next pack";
}

TEST(RecentMinimum, ForgetsOldDurations) {
  RecentMinimum recent;
  EXPECT_EQ(recent.Get(), 0);
  recent.Add(5);
  for (int i = 0; i < 7; ++i) recent.Add(10);
  EXPECT_EQ(recent.Get(), 5);
  recent.Add(10);
  EXPECT_EQ(recent.Get(), 10);
}

class AdjustStageTest : public test::StageRig {
 protected:
  std::int64_t AdjustedSeq() {
    EXPECT_TRUE(results_->latest.Acquire());
    return results_->info[static_cast<std::size_t>(results_->latest.read_slot())].seq;
  }
};

TEST_F(AdjustStageTest, ComputesABacklogInOrderWhileTheDeadlinesCanBeKept) {
  for (std::int64_t seq = 1; seq <= 3; ++seq) Push(seq, kHour);
  for (std::int64_t seq = 1; seq <= 3; ++seq) {
    EXPECT_TRUE(adjust_.Step());
    EXPECT_EQ(AdjustedSeq(), seq);
  }
  EXPECT_FALSE(adjust_.Step()) << "no pack is left";
  EXPECT_EQ(counters_->Dropped(), 0);
}

TEST_F(AdjustStageTest, DropsPacksThatAreLostWhenANewerOneWaits) {
  Push(1, -kHour);
  Push(2, -kHour);
  Push(3, kHour);
  EXPECT_TRUE(adjust_.Step());
  EXPECT_EQ(AdjustedSeq(), 3);
  EXPECT_EQ(counters_->Dropped(), 2);
  EXPECT_EQ(monitor_->misses(MissCause::kOwn), 2) << "a dropped pack is a missed deadline";
  EXPECT_NE(counters_->faults.Take() & estimator_status_t::FAULT_BACKLOG, 0);
}

TEST_F(AdjustStageTest, ComputesTheNewestPackAlsoWhenItIsLateWithTheWholeBudget) {
  Push(1, -kHour);
  Push(2, -kHour);
  EXPECT_TRUE(adjust_.Step());
  EXPECT_EQ(AdjustedSeq(), 2);
  EXPECT_EQ(counters_->Dropped(), 1);
  EXPECT_GT(engine_.last_budget_ns.load(), 0);
  EXPECT_LE(engine_.last_budget_ns.load(), settings_.adjust_budget_ns);
}

TEST_F(AdjustStageTest, LeavesExecuteTheTimeThatItNeeds) {
  RtSettings slow;
  slow.period_ns = slow.deadline_ns = 10 * kNanosPerSecond;
  slow.adjust_budget_ns = 8 * kNanosPerSecond;
  AdjustStage stage(slow, &engine_, ring_.get(), results_.get(), monitor_.get(), counters_.get(), &events_);
  Push(1, 5 * kNanosPerSecond);
  EXPECT_TRUE(stage.Step());
  EXPECT_GT(engine_.last_budget_ns.load(), 0);
  EXPECT_LE(engine_.last_budget_ns.load(), 3 * kNanosPerSecond) << "two of the five seconds are for execute";
}

TEST_F(AdjustStageTest, DoesNotOvertakeAResultThatCanStillBeUsed) {
  Push(1, kHour);
  Push(2, kHour);
  EXPECT_TRUE(adjust_.Step());
  EXPECT_FALSE(adjust_.Step()) << "execute has not taken the first";
  EXPECT_EQ(AdjustedSeq(), 1);
  EXPECT_TRUE(adjust_.Step());
  EXPECT_EQ(AdjustedSeq(), 2);
  EXPECT_EQ(counters_->Dropped(), 0);
}

TEST_F(AdjustStageTest, CountsAResultThatExecuteTookNotInTime) {
  Push(1, -kHour);
  EXPECT_TRUE(adjust_.Step());
  Push(2, kHour);
  EXPECT_TRUE(adjust_.Step());
  EXPECT_EQ(AdjustedSeq(), 2) << "the newest wins";
  EXPECT_EQ(counters_->Dropped(), 1);
}

TEST_F(AdjustStageTest, RemembersWhatItHasHandedOver) {
  Push(1, kHour);
  EXPECT_TRUE(adjust_.Step());
  EXPECT_EQ(AdjustedSeq(), 1) << "the result does not wait for it";
  EXPECT_EQ(engine_.remembered.load(), 0);
  adjust_.Remember();
  EXPECT_EQ(engine_.remembered.load(), 1);
}

TEST_F(AdjustStageTest, FlagsTruncationAndNumericTrouble) {
  engine_.status = Status::kTruncated;
  Push(1, kHour);
  EXPECT_TRUE(adjust_.Step());
  EXPECT_EQ(counters_->adjust.truncated.Get(), 1);
  EXPECT_EQ(counters_->faults.Take(), estimator_status_t::FAULT_TRUNCATED);
  EXPECT_EQ(AdjustedSeq(), 1);
  engine_.status = Status::kNonFinite;
  Push(2, kHour);
  EXPECT_TRUE(adjust_.Step());
  EXPECT_EQ(counters_->adjust.numeric.Get(), 1);
  EXPECT_EQ(counters_->faults.Take(), estimator_status_t::FAULT_NUMERIC);
}

}  // namespace
}  // namespace armcmc::rt::adjust_stage_test
