#include "armcmc/rt/log_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace armcmc::rt::log_histogram_test {
namespace {

TEST(LogHistogram, IsZeroWhenEmptyAndExactForOneRepeatedValue) {
  LogHistogram h;
  EXPECT_EQ(h.Quantile(0.5), 0.0);
  EXPECT_EQ(h.max(), 0.0);
  EXPECT_EQ(h.min(), 0.0);
  for (int i = 0; i < 200; ++i) h.Add(14'979);
  EXPECT_EQ(h.Quantile(0.5), 14'979.0);
  EXPECT_EQ(h.Quantile(0.999), 14'979.0);
}

TEST(LogHistogram, IsWithinItsBucketOfTheExactOrderStatistic) {
  std::vector<std::int64_t> values;
  LogHistogram h;
  std::uint64_t state = 1;
  for (int i = 0; i < 10'000; ++i) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;  // Knuth's MMIX generator
    const auto v = static_cast<std::int64_t>(state >> (20U + (static_cast<unsigned>(i) % 40U)));
    values.push_back(v);
    h.Add(v);
  }
  std::sort(values.begin(), values.end());
  for (const double q : {0.01, 0.5, 0.9, 0.99, 0.999}) {
    const auto exact = static_cast<double>(values[static_cast<std::size_t>(std::ceil(q * 10'000.0)) - 1]);
    EXPECT_NEAR(h.Quantile(q), exact, exact / 31.0 + 1.0) << q;
  }
  EXPECT_EQ(h.max(), static_cast<double>(values.back()));
}

TEST(LogHistogram, TakesExtremesWithoutLeavingItsMemory) {
  LogHistogram h;
  h.Add(-5);
  h.Add(0);
  h.Add(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(h.count(), 3U);
  EXPECT_EQ(h.Quantile(0.1), 0.0);
  EXPECT_EQ(h.Quantile(1.0), static_cast<double>(std::numeric_limits<std::int64_t>::max()));
}

TEST(LogHistogram, MergesCountsAndExtremes) {
  LogHistogram a, b;
  a.Add(10);
  b.Add(1000);
  b.Add(5);
  a.Merge(b);
  EXPECT_EQ(a.count(), 3U);
  EXPECT_EQ(a.min(), 5.0);
  EXPECT_EQ(a.max(), 1000.0);
  EXPECT_EQ(a.Quantile(0.5), 10.0);
}

}  // namespace
}  // namespace armcmc::rt::log_histogram_test
