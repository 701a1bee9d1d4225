#include "armcmc/draw_pace.hpp"

#include <gtest/gtest.h>

namespace armcmc::draw_pace_test {
namespace {

TEST(DrawPace, TellsHowMuchSlowerAPackIs) {
  DrawPace pace;
  pace.Add(80'000, 1000);
  EXPECT_DOUBLE_EQ(pace.Slowness(40'000, 500), 1.0) << "for one draw, whatever their number";
  EXPECT_DOUBLE_EQ(pace.Slowness(60'000, 500), 1.5);
  EXPECT_DOUBLE_EQ(pace.Slowness(10'000, 500), 1.0) << "a fast stretch promises nothing";
}

TEST(DrawPace, AStallIsNoPace) {
  DrawPace pace;
  pace.Add(80'000, 1000);
  EXPECT_DOUBLE_EQ(pace.Slowness(50'000'000, 1000), DrawPace::kMost);
  pace.Add(50'000'000, 1000);
  EXPECT_GT(pace.Slowness(160'000, 1000), 1.5) << "nor does it make slow packs look usual";
}

TEST(DrawPace, FollowsWhatHasBecomeSlowerForGood) {
  DrawPace pace;
  pace.Add(80'000, 1000);
  for (int i = 0; i < 30; ++i) pace.Add(200'000, 1000);
  EXPECT_LT(pace.Slowness(200'000, 1000), 1.05);
}

TEST(DrawPace, AClockThatStandsStillIsNoTrouble) {
  DrawPace pace;
  pace.Add(0, 1000);
  EXPECT_EQ(pace.Slowness(0, 1000), 1.0);
  EXPECT_EQ(pace.Slowness(80'000, 1000), 1.0) << "no pace is known yet";
  pace.Add(80'000, 1000);
  EXPECT_EQ(pace.Slowness(80'000, 1000), 1.0);
}

}  // namespace
}  // namespace armcmc::draw_pace_test
