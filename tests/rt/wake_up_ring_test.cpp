#include <gtest/gtest.h>

#include <memory>

#include "armcmc/rt/witness.hpp"

namespace armcmc::rt {
namespace {

TEST(WakeUpRing, SeesNoStallWhenNothingWasRecorded) {
  const auto ring = std::make_unique<WakeUpRing>();
  EXPECT_EQ(ring->LongestStall(0, 1000, 1000), 0);
}

TEST(WakeUpRing, FindsTheLongestStallInsideTheWindow) {
  const auto ring = std::make_unique<WakeUpRing>();
  ring->Record(100, 101, 200);
  ring->Record(200, 260, 300);
  ring->Record(300, 310, 400);
  EXPECT_EQ(ring->LongestStall(0, 390, 390), 60);
  EXPECT_EQ(ring->LongestStall(270, 390, 390), 10) << "the long one ended before the window";
  EXPECT_EQ(ring->LongestStall(0, 150, 390), 1) << "the long one began after it";
}

TEST(WakeUpRing, CountsOnlyThePartInsideTheWindow) {
  const auto ring = std::make_unique<WakeUpRing>();
  ring->Record(200, 260, 300);
  EXPECT_EQ(ring->LongestStall(240, 1000, 290), 20);
  EXPECT_EQ(ring->LongestStall(0, 230, 290), 30);
}

TEST(WakeUpRing, DoesNotAddStallsUp) {
  const auto ring = std::make_unique<WakeUpRing>();
  for (Nanos due = 100; due < 10'000; due += 100) ring->Record(due, due + 20, due + 100);
  EXPECT_EQ(ring->LongestStall(0, 9990, 9990), 20);
}

TEST(WakeUpRing, CountsAWakeUpThatIsStillOverdue) {
  const auto ring = std::make_unique<WakeUpRing>();
  ring->Record(100, 101, 200);
  EXPECT_EQ(ring->LongestStall(0, 750, 750), 550);
}

TEST(WakeUpRing, KeepsTheNewestWhenItWrapsAround) {
  const auto ring = std::make_unique<WakeUpRing>();
  Nanos due = 0;
  for (std::size_t i = 0; i < 3 * WakeUpRing::kSize; ++i) {
    due += 100;
    ring->Record(due, due + (i == 3 * WakeUpRing::kSize - 10 ? 70 : 1), due + 100);
  }
  EXPECT_EQ(ring->LongestStall(due - 2000, due + 50, due + 50), 70);
  EXPECT_EQ(ring->LongestStall(due - 500, due + 50, due + 50), 1);
}

}  // namespace
}  // namespace armcmc::rt
