#include "armcmc/plant_sim/latency_histogram.hpp"

#include <gtest/gtest.h>

namespace armcmc::plant_sim::latency_histogram_test {
namespace {

TEST(LatencyHistogram, QuantilesAreWithinOneBin) {
  LatencyHistogram histogram;
  for (int us = 1; us <= 10'000; ++us) histogram.Add(us * 1000LL);
  EXPECT_NEAR(histogram.QuantileMs(0.5), 5.0, 5.0 * 0.045);
  EXPECT_NEAR(histogram.QuantileMs(0.99), 9.9, 9.9 * 0.045);
  EXPECT_EQ(histogram.max_ms(), 10.0);
  EXPECT_EQ(histogram.count(), 10'000);
}

TEST(LatencyHistogram, SurvivesExtremes) {
  LatencyHistogram histogram;
  EXPECT_EQ(histogram.QuantileMs(0.5), 0.0);
  histogram.Add(-5);
  EXPECT_EQ(histogram.max_ms(), 0.0);
  histogram.Add(1'000'000'000'000'000);
  EXPECT_LE(histogram.QuantileMs(1.0), histogram.max_ms());
}

}  // namespace
}  // namespace armcmc::plant_sim::latency_histogram_test
