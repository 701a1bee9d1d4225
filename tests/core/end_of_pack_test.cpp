#include "armcmc/end_of_pack.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "armcmc/normal_mixture.hpp"

namespace armcmc::end_of_pack_test {
namespace {

using Mixture = NormalMixture<4>;

struct Law {
  double share, mean, sd;
};

template <std::size_t kCount>
Mixture Of(const std::array<Law, kCount>& laws) {
  Mixture mixture;
  for (const Law& law : laws) mixture.Add(law.share, law.mean, law.sd * law.sd);
  return mixture;
}

template <std::size_t kCount>
double Cdf(const std::array<Law, kCount>& laws, double x) {
  double sum = 0.0, total = 0.0;
  for (const Law& law : laws) {
    sum += law.share * 0.5 * std::erfc((law.mean - x) / (law.sd * std::numbers::sqrt2));
    total += law.share;
  }
  return sum / total;
}

/// Probabilities, and where the standard normal law has them.
constexpr std::array<std::array<double, 2>, 5> kLevels{
    {{0.001, -3.090232}, {0.025, -1.959964}, {0.5, 0.0}, {0.75, 0.674490}, {0.999, 3.090232}}};

EndOfPack::Quantiles QuantilesOf(const Mixture& mixture) {
  EndOfPack::Quantiles q{};
  for (std::size_t k = 0; k < q.size(); ++k) q[k] = mixture.Quantile(EndOfPack::kLevels[k].p, EndOfPack::kLevels[k].z);
  return q;
}

TEST(NormalMixture, OfOneLawHasItsQuantiles) {
  const Mixture one = Of(std::array<Law, 1>{{{1.0, 2.0, 0.5}}});
  for (const auto& [p, z] : kLevels) EXPECT_NEAR(one.Quantile(p, z), 2.0 + 0.5 * z, 1e-3);
}

TEST(NormalMixture, QuantilesInvertTheDistribution) {
  const std::array<Law, 3> narrow_and_wide{{{0.8, 0.0, 0.1}, {0.15, 0.3, 1.0}, {0.05, -2.0, 0.05}}};
  const std::array<Law, 2> far_apart{{{0.6, -5.0, 0.01}, {0.4, 5.0, 0.02}}};
  for (const auto& [p, z] : kLevels) {
    EXPECT_NEAR(Cdf(narrow_and_wide, Of(narrow_and_wide).Quantile(p, z)), p, 1e-3) << p;
    EXPECT_NEAR(Cdf(far_apart, Of(far_apart).Quantile(p, z)), p, 1e-3) << p;
  }
}

TEST(NormalMixture, TakesSmallOnesForOneOfTheirMeanAndVariance) {
  NormalMixture<100> many;
  many.Add(0.5, 0.0, 1.0);
  double square = 0.0;
  for (int i = 0; i < 500; ++i) {
    const double mean = 5.0 + 0.1 * (i % 50);
    many.Add(0.001, mean, 0.04);
    square += (0.04 + (mean - 7.45) * (mean - 7.45)) / 500.0;
  }
  const std::array<Law, 2> two{{{0.5, 0.0, 1.0}, {0.5, 7.45, std::sqrt(square)}}};
  for (const auto& [p, z] : kLevels) EXPECT_NEAR(Cdf(two, many.Quantile(p, z)), p, 1e-3);
  EXPECT_TRUE(std::isnan(Mixture().Quantile(0.5, 0.0)));
}

TEST(EndOfPack, AParameterThatDoesNotMoveStays) {
  const EndOfPack stays;
  for (const double v : {-40.0, 0.0, 0.3}) EXPECT_EQ(stays(v), v);
}

TEST(EndOfPack, TurnsOneDistributionIntoTheOther) {
  const std::array<Law, 1> effective{{{1.0, 1.0, 0.2}}};
  const std::array<Law, 2> at_end{{{0.7, 1.5, 0.05}, {0.3, 1.4, 0.2}}};
  const auto from = QuantilesOf(Of(effective)), to = QuantilesOf(Of(at_end));
  const EndOfPack end(from, to, 0.0, EndOfPack::AverageSlope(from, to), -100.0, 100.0);
  double before = -HUGE_VAL;
  for (int eighths = -32; eighths <= 32; ++eighths) {
    const double z = 0.125 * eighths;
    const double v = 1.0 + 0.2 * z;
    EXPECT_GT(end(v), before);
    before = end(v);
    EXPECT_NEAR(Cdf(at_end, end(v)), Cdf(effective, v), 0.05) << z << ": between the knots";
  }
  for (const double z : {-1.959964, -0.674490, 0.0, 0.674490, 1.959964})
    EXPECT_NEAR(Cdf(at_end, end(1.0 + 0.2 * z)), Cdf(effective, 1.0 + 0.2 * z), 2e-3) << z;
}

TEST(EndOfPack, KeepsWhatTheDrawsHaveBeyondTheExpansion) {
  const auto effective = QuantilesOf(Of(std::array<Law, 1>{{{1.0, 0.0, 1.0}}}));
  const auto at_end = QuantilesOf(Of(std::array<Law, 1>{{{1.0, 0.5, 2.0}}}));
  const EndOfPack end(effective, at_end, 0.1, EndOfPack::AverageSlope(effective, at_end), -100.0, 100.0);
  EXPECT_NEAR(end(0.1), 0.6, 2e-3);
  EXPECT_NEAR(end(1.1), 2.6, 5e-3);
  EXPECT_NEAR(end(10.1), 20.6, 0.1);
}

TEST(EndOfPack, HasOneSlopeBeyondTheOutermostQuantiles) {
  const auto effective = QuantilesOf(Of(std::array<Law, 1>{{{1.0, 0.0, 1.0}}}));
  const auto at_end = QuantilesOf(Of(std::array<Law, 1>{{{1.0, 0.5, 2.0}}}));
  const EndOfPack end(effective, at_end, 0.0, 5.0, -100.0, 100.0);
  EXPECT_NEAR(end(effective.back()), at_end.back(), 1e-9);
  EXPECT_NEAR(end(effective.back() + 1.0), at_end.back() + 5.0, 1e-9);
  EXPECT_NEAR(end(effective.front() - 1.0), at_end.front() - 5.0, 1e-9);
  EXPECT_NEAR(end(0.0), 0.5, 2e-3);
}

TEST(EndOfPack, MovesAndStretchesAboutTheMean) {
  const EndOfPack end(2.0, 0.5, 3.0, -100.0, 100.0);
  EXPECT_NEAR(end(2.0), 2.5, 1e-12);
  EXPECT_NEAR(end(3.0), 5.5, 1e-12);
  EXPECT_NEAR(end(1.0), -0.5, 1e-12);
}

TEST(EndOfPack, KeepsTheBounds) {
  const EndOfPack end(0.0, 0.5, 3.0, -1.0, 2.0);
  EXPECT_EQ(end(5.0), 2.0);
  EXPECT_EQ(end(-5.0), -1.0);
}

TEST(EndOfPack, SaysWhenItIsOfNoUse) {
  EXPECT_TRUE(EndOfPack(0.0, 0.5, 3.0, -1.0, 2.0).IsFinite());
  EXPECT_FALSE(EndOfPack(0.0, 0.5, std::nan(""), -1.0, 2.0).IsFinite());
  const auto quantiles = QuantilesOf(Of(std::array<Law, 1>{{{1.0, 0.0, 1.0}}}));
  EXPECT_FALSE(EndOfPack(EndOfPack::Quantiles{}, quantiles, 0.0, 1.0, -1.0, 2.0).IsFinite())
      << "one point for a quantile";
}

}  // namespace
}  // namespace armcmc::end_of_pack_test
