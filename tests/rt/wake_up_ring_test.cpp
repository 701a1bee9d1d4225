#include <gtest/gtest.h>

#include <memory>

#include "armcmc/rt/witness.hpp"

namespace armcmc::rt::wake_up_ring_test {
namespace {

constexpr Nanos kMs = 1'000'000;
constexpr Nanos kOrdinary = 50'000;

TEST(WakeUpRing, SeesNoStallWhenNothingWasRecorded) {
  const auto ring = std::make_unique<WakeUpRing>();
  EXPECT_EQ(ring->StalledTime(0, 1000 * kMs, 1000 * kMs), 0);
}

TEST(WakeUpRing, FindsTheStallsInsideTheWindow) {
  const auto ring = std::make_unique<WakeUpRing>();
  ring->Record(100 * kMs, 100 * kMs + kOrdinary, 200 * kMs);
  ring->Record(200 * kMs, 260 * kMs, 300 * kMs);
  ring->Record(300 * kMs, 310 * kMs, 400 * kMs);
  EXPECT_EQ(ring->StalledTime(0, 390 * kMs, 390 * kMs), 70 * kMs);
  EXPECT_EQ(ring->StalledTime(270 * kMs, 390 * kMs, 390 * kMs), 10 * kMs) << "the long one ended before the window";
  EXPECT_EQ(ring->StalledTime(0, 150 * kMs, 390 * kMs), 0) << "both began after it";
}

TEST(WakeUpRing, CountsOnlyThePartInsideTheWindow) {
  const auto ring = std::make_unique<WakeUpRing>();
  ring->Record(200 * kMs, 260 * kMs, 300 * kMs);
  EXPECT_EQ(ring->StalledTime(240 * kMs, 1000 * kMs, 290 * kMs), 20 * kMs);
  EXPECT_EQ(ring->StalledTime(0, 230 * kMs, 290 * kMs), 30 * kMs);
}

TEST(WakeUpRing, AddsUpTheSlicesThatAHypervisorTakes) {
  const auto ring = std::make_unique<WakeUpRing>();
  for (Nanos due = kMs; due < 20 * kMs; due += 2 * kMs) ring->Record(due, due + kMs, due + 2 * kMs);
  EXPECT_EQ(ring->StalledTime(0, 20 * kMs, 20 * kMs), 10 * kMs);
}

TEST(WakeUpRing, AHundredOrdinaryLatenciesAreNoStall) {
  const auto ring = std::make_unique<WakeUpRing>();
  for (Nanos due = kMs; due < 101 * kMs; due += kMs) {
    ring->Record(due, due + WakeUpRing::kOrdinaryDelayNs, due + kMs);
  }
  EXPECT_EQ(ring->StalledTime(0, 101 * kMs, 101 * kMs), 0);
}

TEST(WakeUpRing, CountsAWakeUpThatIsStillOverdue) {
  const auto ring = std::make_unique<WakeUpRing>();
  ring->Record(100 * kMs, 100 * kMs + kOrdinary, 200 * kMs);
  EXPECT_EQ(ring->StalledTime(0, 750 * kMs, 750 * kMs), 550 * kMs);
}

TEST(WakeUpRing, KeepsTheNewestWhenItWrapsAround) {
  const auto ring = std::make_unique<WakeUpRing>();
  Nanos due = 0;
  for (std::size_t i = 0; i < 3 * WakeUpRing::kSize; ++i) {
    due += 10 * kMs;
    ring->Record(due, due + (i == 3 * WakeUpRing::kSize - 10 ? 7 * kMs : kOrdinary), due + 10 * kMs);
  }
  EXPECT_EQ(ring->StalledTime(due - 200 * kMs, due + 5 * kMs, due + 5 * kMs), 7 * kMs);
  EXPECT_EQ(ring->StalledTime(due - 50 * kMs, due + 5 * kMs, due + 5 * kMs), 0);
}

}  // namespace
}  // namespace armcmc::rt::wake_up_ring_test
