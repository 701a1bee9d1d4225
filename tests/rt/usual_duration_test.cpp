#include "armcmc/rt/usual_duration.hpp"

#include <gtest/gtest.h>

namespace armcmc::rt {
namespace {

class UsualDurationTest : public ::testing::Test {
 protected:
  /// 32 undisturbed times, the longest of 400.
  void Learn() {
    for (int i = 0; i < 32; ++i) EXPECT_EQ(usual_.Stalled(i == 7 ? 400 : 300, 0), 0);
  }
  UsualDuration usual_;
};

TEST_F(UsualDurationTest, TheMachineTookAllOfAnExcessOfWhichHalfWasSeen) {
  Learn();
  EXPECT_EQ(usual_.Stalled(2400, 1000), 2000);
  EXPECT_EQ(usual_.Stalled(2400, 999), 999) << "less than half: the rest may be our own";
  EXPECT_EQ(usual_.Stalled(2400, 2200), 2200) << "never less than was seen";
}

TEST_F(UsualDurationTest, WhatWasNotSeenIsOurOwn) {
  Learn();
  EXPECT_EQ(usual_.Stalled(5000, 0), 0);
  EXPECT_EQ(usual_.Stalled(5700, 300), 300);
}

TEST_F(UsualDurationTest, WhatWeOurselvesTookLatelyIsNoExcess) {
  Learn();
  EXPECT_EQ(usual_.Stalled(1400, 0), 0);
  EXPECT_EQ(usual_.Stalled(2400, 500), 1000);
  for (int i = 0; i < 32; ++i) (void)usual_.Stalled(300, 0);
  EXPECT_EQ(usual_.Stalled(2400, 500), 500) << "long ago";
}

TEST_F(UsualDurationTest, KnowsNothingUsualAtFirst) {
  EXPECT_EQ(usual_.Stalled(300, 0), 0);
  EXPECT_EQ(usual_.Stalled(2400, 1500), 1500);
}

}  // namespace
}  // namespace armcmc::rt
