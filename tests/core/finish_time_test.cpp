#include "armcmc/finish_time.hpp"

#include <gtest/gtest.h>

namespace armcmc::finish_time_test {
namespace {

TEST(FinishTime, FewerDrawsAreHeldToTakeAsLong) {
  FinishTime time;
  time.Add(100'000, 1000);
  EXPECT_EQ(time.Predict(1000), 100'000);
  EXPECT_EQ(time.Predict(300), 100'000) << "part of the time is the same for any number of draws";
  EXPECT_EQ(time.Predict(2000), 200'000);
}

TEST(FinishTime, HoldsForWorkThatIsPartlyFixed) {
  // 60 us for any pack, 40 ns for each draw. Packs that are cut, and a full one after them.
  const auto truth = [](int draws) { return Nanos{60'000} + 40 * draws; };
  FinishTime time;
  time.Add(truth(1000), 1000);
  for (int i = 0; i < 30; ++i) {
    EXPECT_GE(time.Predict(300), truth(300)) << i;
    time.Add(truth(300), 300);
  }
  EXPECT_GE(time.Predict(1000), truth(300));
  EXPECT_LE(time.Predict(1000), truth(1000)) << "it would be cut, too, if few draws were taken in proportion";
}

TEST(FinishTime, ForgetsSlowlyAndFollowsWhatHasBecomeSlower) {
  FinishTime time;
  time.Add(100'000, 1000);
  time.Add(10'000, 1000);
  EXPECT_EQ(time.Predict(1000), 90'000);
  for (int i = 0; i < 5; ++i) time.Add(800'000, 1000);
  EXPECT_EQ(time.Predict(1000), 800'000);
}

TEST(FinishTime, OneStallDoublesItAtMost) {
  FinishTime time;
  time.Add(100'000, 1000);
  time.Add(50'000'000, 1000);
  EXPECT_EQ(time.Predict(1000), 200'000);
}

}  // namespace
}  // namespace armcmc::finish_time_test
