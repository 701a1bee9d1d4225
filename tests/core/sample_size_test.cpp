#include "armcmc/sample_size.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

namespace armcmc {
namespace {

constexpr double kEpsilon = 0.01;
constexpr double kDelta = 0.9;

struct Row {
  double lambda, k_min, digit;
};

// Roots of equation (neval) at eps = 0.01, delta = 0.9, to a unit of the last digit given.
constexpr Row kTable[] = {{0.1, 4633.0, 1.0},  {0.3, 5219.0, 0.1},   {0.5, 6054.9, 0.1}, {0.7, 7405.8, 0.1},
                          {0.9, 10345.1, 0.1}, {0.99, 14132.0, 1.0}, {1.0, 14978.7, 0.1}};

TEST(MinimumDraws, MatchesTheTabulatedRoots) {
  for (const Row& row : kTable)
    EXPECT_NEAR(MinimumDraws(row.lambda, kEpsilon, kDelta), row.k_min, row.digit) << "lambda = " << row.lambda;
}

TEST(MinimumDraws, SolvesItsEquation) {
  for (double lambda = 0.001; lambda < 1.0; lambda += 0.001) {
    const double k = MinimumDraws(lambda, kEpsilon, kDelta);
    const double rate = 2.0 * kEpsilon * kEpsilon;
    const double inner = lambda * (1.0 - kDelta) + 2.0 * (1.0 - lambda) * std::exp(-rate * (1.0 - lambda) * k);
    // Near lambda = 0 the relation is nearly k = k: its residual is flat, and so is its rounding error.
    EXPECT_NEAR(std::log(2.0 / inner) / rate, k, 1e-6) << "lambda = " << lambda;
  }
}

TEST(MinimumDraws, RisesWithLambda) {
  double before = 0.0;
  for (double lambda = 0.001; lambda <= 1.0; lambda += 0.001) {
    const double k = MinimumDraws(lambda, kEpsilon, kDelta);
    EXPECT_GT(k, before) << "lambda = " << lambda;
    before = k;
  }
}

TEST(MinimumDraws, IsTheChernoffNumberWhereTheRelationIsDegenerate) {
  EXPECT_EQ(MinimumDraws(0.0, kEpsilon, kDelta), ChernoffBound(kEpsilon, kDelta));
  EXPECT_EQ(MinimumDraws(1.0, kEpsilon, kDelta), ChernoffBound(kEpsilon, kDelta));
}

TEST(MinimumDraws, ClampsLambda) {
  EXPECT_EQ(MinimumDraws(-1.0, kEpsilon, kDelta), MinimumDraws(0.0, kEpsilon, kDelta));
  EXPECT_EQ(MinimumDraws(2.0, kEpsilon, kDelta), MinimumDraws(1.0, kEpsilon, kDelta));
  EXPECT_EQ(MinimumDraws(std::numeric_limits<double>::quiet_NaN(), kEpsilon, kDelta), ChernoffBound(kEpsilon, kDelta));
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

RC_GTEST_PROP(MinimumDraws, IsFiniteAndAtMostTheChernoffNumber, ()) {
  const auto unit = [](int n) { return n / 1'000'000.0; };
  const double lambda = unit(*rc::gen::inRange(0, 1'000'001));
  const double epsilon = unit(*rc::gen::inRange(1, 1'000'000));
  const double delta = unit(*rc::gen::inRange(1, 1'000'000));
  const double k = MinimumDraws(lambda, epsilon, delta);
  RC_ASSERT(std::isfinite(k));
  RC_ASSERT(k > 0.0);
  RC_ASSERT(k <= ChernoffBound(epsilon, delta));
}

}  // namespace
}  // namespace armcmc
