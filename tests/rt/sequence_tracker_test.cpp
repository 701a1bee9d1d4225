#include "armcmc/rt/sequence_tracker.hpp"

#include <gtest/gtest.h>

namespace armcmc::rt::sequence_tracker_test {
namespace {

using V = SequenceVerdict;

TEST(SequenceTracker, TakesPacksInOrderAndCountsAGapAsLost) {
  SequenceTracker t;
  EXPECT_EQ(t.OnPack(17, 1).verdict, V::kFirst);
  EXPECT_EQ(t.OnPack(18, 1).verdict, V::kNext);
  EXPECT_EQ(t.counts().lost, 0) << "numbers before the first pack were never ours";
  const auto result = t.OnPack(22, 1);
  EXPECT_EQ(result.verdict, V::kNext);
  EXPECT_EQ(result.steps, 4);
  EXPECT_EQ(t.counts().lost, 3);
}

TEST(SequenceTracker, CountsTheSameNumberAgainAsDuplicate) {
  SequenceTracker t;
  t.OnPack(1, 1);
  t.OnPack(2, 1);
  EXPECT_EQ(t.OnPack(2, 1).verdict, V::kDuplicate);
  EXPECT_EQ(t.OnPack(1, 1).verdict, V::kDuplicate);
  EXPECT_EQ(t.counts().duplicate, 2);
  EXPECT_EQ(t.counts().reordered, 0);
}

TEST(SequenceTracker, APackThatComesLateIsReorderedAndNotLost) {
  SequenceTracker t;
  t.OnPack(1, 1);
  t.OnPack(3, 1);
  EXPECT_EQ(t.counts().lost, 1);
  EXPECT_EQ(t.OnPack(2, 1).verdict, V::kReordered);
  EXPECT_EQ(t.counts().lost, 0);
  EXPECT_EQ(t.counts().reordered, 1);
  EXPECT_EQ(t.OnPack(2, 1).verdict, V::kDuplicate) << "and when it comes again";
  EXPECT_EQ(t.OnPack(4, 1).verdict, V::kNext);
}

TEST(SequenceTracker, ANewRunIsARestartWithoutLosses) {
  SequenceTracker t;
  t.OnPack(100, 1);
  EXPECT_EQ(t.OnPack(1, 2).verdict, V::kRestart);
  EXPECT_EQ(t.OnPack(2, 2).verdict, V::kNext);
  EXPECT_EQ(t.counts().restarts, 1);
  EXPECT_EQ(t.counts().lost, 0);
}

TEST(SequenceTracker, APackOfTheRunBeforeIsNotAnotherRestart) {
  SequenceTracker t;
  t.OnPack(100, 1);
  t.OnPack(1, 2);
  EXPECT_EQ(t.OnPack(101, 1).verdict, V::kReordered);
  EXPECT_EQ(t.OnPack(2, 2).verdict, V::kNext);
  EXPECT_EQ(t.counts().restarts, 1);
}

TEST(SequenceTracker, ALogThatIsPlayedAgainIsARestart) {
  SequenceTracker t;
  for (std::int64_t seq = 1; seq <= 40; ++seq) t.OnPack(seq, 1);
  int usable = 0;
  for (std::int64_t seq = 1; seq <= 40; ++seq) usable += IsUsable(t.OnPack(seq, 1).verdict) ? 1 : 0;
  EXPECT_EQ(usable, 41 - SequenceTracker::kRestartRun);
  EXPECT_EQ(t.counts().restarts, 1);
}

TEST(SequenceTracker, AWildNumberDoesNotShutTheEstimatorOut) {
  SequenceTracker t;
  t.OnPack(1, 1);
  EXPECT_EQ(t.OnPack(std::int64_t{1} << 62, 1).verdict, V::kRestart);
  EXPECT_EQ(t.counts().lost, 0);
  EXPECT_EQ(t.OnPack(2, 1).verdict, V::kRestart);
  EXPECT_EQ(t.OnPack(3, 1).verdict, V::kNext);
}

TEST(SequenceTracker, APackThatCannotBeUsedIsNotLost) {
  SequenceTracker t;
  EXPECT_EQ(t.OnUnusable(1, 1), 0) << "nothing is known of the run yet";
  t.OnPack(1, 1);
  EXPECT_EQ(t.OnUnusable(2, 1), 1);
  EXPECT_EQ(t.OnPack(3, 1).steps, 1);
  EXPECT_EQ(t.counts().lost, 0);
}

TEST(SequenceTracker, DoesNotBelieveAWildNumberOfAPackThatCannotBeUsed) {
  SequenceTracker t;
  t.OnPack(10, 1);
  EXPECT_EQ(t.OnUnusable(1'000'000, 1), 0);
  EXPECT_EQ(t.OnUnusable(-5, 1), 0);
  EXPECT_EQ(t.OnUnusable(11, 2), 0);
  EXPECT_EQ(t.OnPack(11, 1).verdict, V::kNext);
  EXPECT_EQ(t.counts().restarts, 0);
}

TEST(SequenceTracker, ForgetsWhatLiesBeyondItsWindowWithoutOverflow) {
  SequenceTracker t;
  t.OnPack(1, 1);
  t.OnPack(200, 1);
  EXPECT_EQ(t.counts().lost, 198);
  EXPECT_EQ(t.OnPack(100, 1).verdict, V::kReordered);
  EXPECT_EQ(t.counts().lost, 198) << "too old to tell a late pack from a repeated one";
}

}  // namespace
}  // namespace armcmc::rt::sequence_tracker_test
