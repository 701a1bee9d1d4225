#include "armcmc/rt/waiter.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "armcmc/rt/clock.hpp"

namespace armcmc::rt {
namespace {

TEST(Waiter, ReturnsAtOnceAfterAPost) {
  Waiter waiter;
  waiter.Post();
  EXPECT_TRUE(waiter.WaitUntil(MonotonicNow() - kNanosPerSecond));
}

TEST(Waiter, GivesUpAtItsTimeAndNotBefore) {
  Waiter waiter;
  const Nanos end = MonotonicNow() + 5 * kNanosPerMilli;
  EXPECT_FALSE(waiter.WaitUntil(end));
  EXPECT_GE(MonotonicNow(), end);
}

TEST(Waiter, IsWokenByAnotherThread) {
  Waiter waiter;
  std::thread other([&waiter] { waiter.Post(); });
  EXPECT_TRUE(waiter.WaitUntil(MonotonicNow() + 20 * kNanosPerSecond));
  other.join();
}

TEST(SleepUntil, DoesNotWakeBeforeItsTime) {
  const Nanos end = MonotonicNow() + 2 * kNanosPerMilli;
  SleepUntil(end);
  EXPECT_GE(MonotonicNow(), end);
}

}  // namespace
}  // namespace armcmc::rt
