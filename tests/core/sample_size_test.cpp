#include "armcmc/sample_size.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace armcmc::sample_size_test {
namespace {

constexpr double kEpsilon = 0.01;
constexpr double kDelta = 0.9;

struct Row {
  double lambda, epsilon, delta, k_min, digit;
};

// Roots of equation (neval), to a unit of the last digit given.
constexpr Row kTable[] = {{0.1, 0.01, 0.9, 4633.0, 1.0},    {0.3, 0.01, 0.9, 5219.0, 0.1},
                          {0.5, 0.01, 0.9, 6054.9, 0.1},    {0.7, 0.01, 0.9, 7405.8, 0.1},
                          {0.9, 0.01, 0.9, 10345.1, 0.1},   {0.99, 0.01, 0.9, 14132.0, 1.0},
                          {0.5, 0.05, 0.5, 152.497, 0.001}, {0.5, 0.05, 0.99, 273.318, 0.001}};

TEST(MinimumDraws, MatchesTheTabulatedRoots) {
  for (const Row& row : kTable)
    EXPECT_NEAR(MinimumDraws(row.lambda, row.epsilon, row.delta), row.k_min, row.digit) << "lambda = " << row.lambda;
}

TEST(MinimumDraws, IsTheChernoffNumberWhereTheRelationIsDegenerate) {
  // Values outside [0, 1] are held to them, and what is no number is a modification.
  for (const double lambda : {0.0, 1.0, -1.0, 2.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(MinimumDraws(lambda, kEpsilon, kDelta), ChernoffBound(kEpsilon, kDelta)) << lambda;
}

TEST(ChernoffDraws, RoundsTheBoundUp) {
  EXPECT_NEAR(ChernoffBound(kEpsilon, kDelta), std::log(20.0) / 2e-4, 1e-9);
  EXPECT_EQ(ChernoffDraws(kEpsilon, kDelta), 14979);
  EXPECT_EQ(ChernoffDraws(0.1, 0.9), 150);
}

// log(20) / (2 * 1e-12) = 1.5e12 is more than an int holds.
TEST(ChernoffDraws, NeverAsksForLessWhenThePrecisionIsOutOfReach) {
  EXPECT_GE(ChernoffDraws(1e-6, kDelta), ChernoffDraws(1e-4, kDelta));
  EXPECT_GE(ChernoffDraws(1e-6, 1.0 - 1e-15), ChernoffDraws(1e-4, kDelta));
}

}  // namespace
}  // namespace armcmc::sample_size_test
