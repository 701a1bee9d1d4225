#include "armcmc/plant_sim/estimator_watch.hpp"

#include <gtest/gtest.h>

namespace armcmc::plant_sim::estimator_watch_test {
namespace {

TEST(EstimatorWatch, NoticesASilenceOnceAndItsEndOnce) {
  EstimatorWatch watch(100);
  EXPECT_FALSE(watch.NoticeSilence(900)) << "nobody has answered yet";
  EXPECT_FALSE(watch.OnEstimate(1000));
  EXPECT_FALSE(watch.NoticeSilence(1250));
  EXPECT_TRUE(watch.NoticeSilence(1251));
  EXPECT_FALSE(watch.NoticeSilence(2000));
  EXPECT_TRUE(watch.silent());
  EXPECT_TRUE(watch.OnEstimate(3000));
  EXPECT_FALSE(watch.OnEstimate(3100));
  EXPECT_TRUE(watch.NoticeSilence(9000));
  EXPECT_EQ(watch.silences(), 2);
}

}  // namespace
}  // namespace armcmc::plant_sim::estimator_watch_test
