#include "armcmc/rt/waiter.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "armcmc/rt/clock.hpp"

namespace armcmc::rt::waiter_test {
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

TEST(Waiter, TellsWhenTheFirstPostCame) {
  Waiter waiter;
  EXPECT_EQ(waiter.TakePostTime(), 0);
  const Nanos before = MonotonicNow();
  waiter.Post();
  const Nanos between = MonotonicNow();
  waiter.Post();
  const Nanos told = waiter.TakePostTime();
  EXPECT_GE(told, before);
  EXPECT_LE(told, between);
  EXPECT_EQ(waiter.TakePostTime(), 0) << "taken";
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
}  // namespace armcmc::rt::waiter_test
