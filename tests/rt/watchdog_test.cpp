#include "armcmc/rt/watchdog.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace armcmc::rt::watchdog_test {
namespace {

constexpr Nanos kT = 100'000'000;

class WatchdogTest : public ::testing::Test {
 protected:
  /// Checks on time from `from` until `to`.
  void CheckUntil(Nanos to) {
    for (; now_ <= to; now_ += dog_.check_period_ns()) dog_.Check(now_, now_);
  }
  std::optional<Event> NextEvent() {
    Event event;
    return events_.Take(&event) ? std::optional(event) : std::nullopt;
  }

  EventLog events_;
  Watchdog dog_{RtSettings{}, &events_};
  Nanos now_ = 0;
};

TEST_F(WatchdogTest, IsContentWhileThreadsAreHeardOf) {
  for (int step = 0; step < 20; ++step) {
    dog_.Announce(Watched::kAdjust, step * kT, kT);
    CheckUntil((step + 1) * kT);
  }
  EXPECT_EQ(dog_.hung(), 0U);
  EXPECT_FALSE(dog_.TakeHung());
}

TEST_F(WatchdogTest, SeesAHangWithinOnePeriodOfTheBrokenPromise) {
  dog_.Announce(Watched::kExecute, 0, kT / 2);
  CheckUntil(kT / 2);
  EXPECT_EQ(dog_.hung(), 0U) << "the promise holds still";
  CheckUntil(kT / 2 + kT);
  EXPECT_EQ(dog_.hung(), 1U << static_cast<unsigned>(Watched::kExecute));
  EXPECT_EQ(dog_.hangs(), 1);
  const auto event = NextEvent();
  ASSERT_TRUE(event.has_value());
  EXPECT_EQ(event->kind, EventKind::kStageHung);
  EXPECT_EQ(event->detail, static_cast<std::uint8_t>(Watched::kExecute));
  EXPECT_LT(event->t_ns, kT / 2 + kT);
}

TEST_F(WatchdogTest, AThreadThatIsHeardOfAgainIsAliveAndWasStillFlagged) {
  dog_.Announce(Watched::kCollect, 0, 0);
  CheckUntil(5 * kT);
  EXPECT_TRUE(dog_.TakeHung());
  dog_.Announce(Watched::kCollect, 5 * kT, kT);
  CheckUntil(5 * kT + kT / 2);
  EXPECT_EQ(dog_.hung(), 0U);
  EXPECT_FALSE(dog_.TakeHung());
  EXPECT_EQ(dog_.hangs(), 1) << "one hang, however long";
}

TEST_F(WatchdogTest, AHangThatIsOverBeforeItIsAskedForIsToldOnce) {
  dog_.Announce(Watched::kPublish, 0, 0);
  CheckUntil(kT);
  dog_.Announce(Watched::kPublish, now_, kT);
  CheckUntil(now_ + kT / 4);
  EXPECT_TRUE(dog_.TakeHung());
  EXPECT_FALSE(dog_.TakeHung());
}

TEST_F(WatchdogTest, AProcessThatWasStoppedAsAWholeHasNotHung) {
  dog_.Announce(Watched::kAdjust, 0, kT / 2);
  CheckUntil(kT / 4);
  dog_.Check(now_, now_ + 20 * kT);  // the check itself came two seconds late
  now_ += 20 * kT + dog_.check_period_ns();
  dog_.Check(now_, now_);
  EXPECT_EQ(dog_.hung(), 0U) << "the stages have had no time to be heard of yet";
  dog_.Announce(Watched::kAdjust, now_, kT);
  CheckUntil(now_ + kT / 2);
  EXPECT_EQ(dog_.hangs(), 0);
}

TEST_F(WatchdogTest, AThreadThatHasEndedIsNotMissed) {
  dog_.Announce(Watched::kAdjust, 0, 0);
  dog_.Dismiss(Watched::kAdjust);
  CheckUntil(3 * kT);
  EXPECT_EQ(dog_.hung(), 0U);
}

}  // namespace
}  // namespace armcmc::rt::watchdog_test
