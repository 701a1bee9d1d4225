#include "armcmc/plots/decimate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace armcmc::plots::decimate_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;

TEST(Decimate, LeavesShortRowsAlone) {
  const std::vector<double> row = {3.0, 1.0, 2.0};
  EXPECT_THAT(Decimate({&row}, 3), ElementsAre(0, 1, 2));
}

TEST(Decimate, KeepsEveryExtremeOfEveryRow) {
  std::vector<double> y(1'000'000, 0.0), low(y.size(), -1.0), high(y.size(), 1.0);
  y[123'456] = 9.0;
  y[765'432] = -9.0;
  low[500'001] = -20.0;
  high[31] = 20.0;
  const std::vector<std::size_t> kept = Decimate({&y, &low, &high}, 4000);
  EXPECT_LE(kept.size(), 4001u);
  for (const std::size_t i : {0ul, 31ul, 123'456ul, 500'001ul, 765'432ul, 999'999ul}) EXPECT_THAT(kept, Contains(i));
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
}

TEST(Decimate, KeepsAGapAGap) {
  std::vector<double> row(10'000, 1.0);
  row[5'000] = std::nan("");
  EXPECT_THAT(Decimate({&row}, 100), Contains(5'000u));
}

TEST(Decimate, CopesWithNothingButGaps) {
  const std::vector<double> row(1'000, std::nan(""));
  const std::size_t kept = Decimate({&row}, 10).size();
  EXPECT_GE(kept, 2u);
  EXPECT_LE(kept, 20u);
}

TEST(Decimate, IgnoresEmptyRows) {
  const std::vector<double> row = {1.0, 2.0}, none;
  EXPECT_THAT(Decimate({&row, &none}, 10), ElementsAre(0, 1));
  EXPECT_THAT(Decimate({&none}, 10), ElementsAre());
}

TEST(Decimate, RefusesRowsThatDoNotFit) {
  const std::vector<double> two(2), three(3);
  EXPECT_THROW((void)Decimate({&two, &three}, 10), std::invalid_argument);
  EXPECT_THROW((void)Decimate({&two}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace armcmc::plots::decimate_test
