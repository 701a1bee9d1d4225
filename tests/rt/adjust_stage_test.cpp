#include "armcmc/rt/adjust_stage.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "armcmc/estimator_status_t.hpp"
#include "armcmc/rt/clock.hpp"
#include "fake_engine.hpp"

namespace armcmc::rt {
namespace {

// Deadlines lie hours in the past or in the future: how fast the machine runs decides nothing here.
constexpr Nanos kHour = 3600 * kNanosPerSecond;

TEST(AdjustDeadline, IsTheBudgetButLeavesTheReserve) {
  EXPECT_EQ(AdjustDeadline(/*start=*/0, /*deadline=*/100, /*budget=*/50, /*reserve=*/20), 50);
  EXPECT_EQ(AdjustDeadline(40, 100, 50, 20), 80);
}

TEST(AdjustDeadline, IsTheWholeBudgetWhenTheDeadlineIsLostAnyway) {
  EXPECT_EQ(AdjustDeadline(80, 100, 50, 20), 130);
  EXPECT_EQ(AdjustDeadline(500, 100, 50, 20), 550);
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

class AdjustStageTest : public ::testing::Test {
 protected:
  void Push(std::int64_t seq, Nanos deadline_from_now_ns) {
    PackSlot* slot = ring_->Claim();
    ASSERT_NE(slot, nullptr);
    const Nanos now = MonotonicNow();
    slot->pack.seq = seq;
    slot->pack.num_samples = 1;
    slot->times = {};
    slot->times.release_ns = slot->times.arrival_ns = now;
    slot->times.deadline_ns = now + deadline_from_now_ns;
    slot->times.end_ns[0] = now;
    ring_->Commit();
  }

  std::int64_t AdjustedSeq() {
    EXPECT_TRUE(results_->latest.Acquire());
    return results_->info[static_cast<std::size_t>(results_->latest.read_slot())].seq;
  }

  RtSettings settings_;
  test::FakeEngine engine_;
  std::unique_ptr<PackRing> ring_ = std::make_unique<PackRing>();
  std::unique_ptr<ResultHandOver> results_ = std::make_unique<ResultHandOver>();
  std::unique_ptr<DeadlineMonitor> monitor_ = std::make_unique<DeadlineMonitor>(settings_);
  std::unique_ptr<Counters> counters_ = std::make_unique<Counters>();
  EventLog events_;
  AdjustStage stage_{settings_, &engine_, ring_.get(), results_.get(), monitor_.get(), counters_.get(), &events_};
};

TEST_F(AdjustStageTest, DoesNothingWithoutAPack) {
  EXPECT_FALSE(stage_.Step());
  EXPECT_FALSE(results_->latest.Acquire());
}

TEST_F(AdjustStageTest, ComputesABacklogInOrderWhileTheDeadlinesCanBeKept) {
  for (std::int64_t seq = 1; seq <= 3; ++seq) Push(seq, kHour);
  for (std::int64_t seq = 1; seq <= 3; ++seq) {
    EXPECT_TRUE(stage_.Step());
    EXPECT_EQ(AdjustedSeq(), seq);
  }
  EXPECT_FALSE(stage_.Step());
  EXPECT_EQ(counters_->Dropped(), 0);
}

TEST_F(AdjustStageTest, DropsPacksThatAreLostWhenANewerOneWaits) {
  Push(1, -kHour);
  Push(2, -kHour);
  Push(3, kHour);
  EXPECT_TRUE(stage_.Step());
  EXPECT_EQ(AdjustedSeq(), 3);
  EXPECT_EQ(counters_->Dropped(), 2);
  EXPECT_EQ(monitor_->misses(MissCause::kOwn), 2) << "a dropped pack is a missed deadline";
  EXPECT_NE(counters_->faults.Take() & estimator_status_t::FAULT_BACKLOG, 0);
}

TEST_F(AdjustStageTest, ComputesTheNewestPackAlsoWhenItIsLate) {
  Push(1, -kHour);
  Push(2, -kHour);
  EXPECT_TRUE(stage_.Step());
  EXPECT_EQ(AdjustedSeq(), 2);
  EXPECT_EQ(counters_->Dropped(), 1);
}

TEST_F(AdjustStageTest, GivesAnHopelesslyLatePackTheWholeBudget) {
  Push(1, -kHour);
  EXPECT_TRUE(stage_.Step());
  EXPECT_GT(engine_.last_budget_ns.load(), 0);
  EXPECT_LE(engine_.last_budget_ns.load(), settings_.adjust_budget_ns);
}

TEST_F(AdjustStageTest, DoesNotOvertakeAResultThatCanStillBeUsed) {
  Push(1, kHour);
  Push(2, kHour);
  EXPECT_TRUE(stage_.Step());
  EXPECT_FALSE(stage_.Step()) << "execute has not taken the first";
  EXPECT_EQ(AdjustedSeq(), 1);
  EXPECT_TRUE(stage_.Step());
  EXPECT_EQ(AdjustedSeq(), 2);
  EXPECT_EQ(counters_->Dropped(), 0);
}

TEST_F(AdjustStageTest, CountsAResultThatExecuteTookNotInTime) {
  Push(1, -kHour);
  EXPECT_TRUE(stage_.Step());
  Push(2, kHour);
  EXPECT_TRUE(stage_.Step());
  EXPECT_EQ(AdjustedSeq(), 2) << "the newest wins";
  EXPECT_EQ(counters_->Dropped(), 1);
}

TEST_F(AdjustStageTest, RemembersWhatItHasHandedOver) {
  Push(1, kHour);
  EXPECT_TRUE(stage_.Step());
  EXPECT_EQ(AdjustedSeq(), 1) << "the result does not wait for it";
  EXPECT_EQ(engine_.remembered.load(), 0);
  stage_.Remember();
  EXPECT_EQ(engine_.remembered.load(), 1);
}

TEST_F(AdjustStageTest, FlagsTruncationAndNumericTrouble) {
  engine_.status = Status::kTruncated;
  Push(1, kHour);
  EXPECT_TRUE(stage_.Step());
  EXPECT_EQ(counters_->adjust.truncated.Get(), 1);
  EXPECT_EQ(counters_->faults.Take(), estimator_status_t::FAULT_TRUNCATED);
  EXPECT_EQ(AdjustedSeq(), 1);
  engine_.status = Status::kNonFinite;
  Push(2, kHour);
  EXPECT_TRUE(stage_.Step());
  EXPECT_EQ(counters_->adjust.numeric.Get(), 1);
  EXPECT_EQ(counters_->faults.Take(), estimator_status_t::FAULT_NUMERIC);
}

}  // namespace
}  // namespace armcmc::rt
