#include "armcmc/plant_sim/noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace armcmc::plant_sim::noise_test {
namespace {

constexpr int kDraws = 200'000;

std::vector<double> Draws(const NoiseLaw& law) {
  Rng rng(2024, 0);
  std::vector<double> draws(kDraws);
  for (double& draw : draws) draw = Draw(law, &rng);
  return draws;
}

/// Kolmogorov-Smirnov distance times sqrt(n): above 1.95 with probability 0.001 when the law is right.
double KolmogorovStatistic(std::vector<double> draws, const std::function<double(double)>& cdf) {
  std::sort(draws.begin(), draws.end());
  const auto n = static_cast<double>(draws.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < draws.size(); ++i) {
    const double p = cdf(draws[i]);
    worst = std::max({worst, p - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - p});
  }
  return worst * std::sqrt(n);
}

double NormalCdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

TEST(Rng, HasTheReferenceSequence) {
  // From an own script that reproduces the published vectors of xoshiro256++ ({1, 2, 3, 4} gives 41943041,
  // 58720359, ...) and splitmix64 (1234567 gives 6457827717110365317).
  Rng rng(1, 0);
  EXPECT_EQ(rng.Next(), 0x4887886c7244e091ULL);
  EXPECT_EQ(rng.Next(), 0x4cfafb3b6cc3ea99ULL);
  EXPECT_EQ(rng.Next(), 0xfbce21167403a2c1ULL);
}

TEST(Rng, SeedAndStreamDoNotTradePlaces) {
  EXPECT_NE(Rng(1, 2).Next(), Rng(2, 1).Next());
  EXPECT_NE(Rng(1, 0).Next(), Rng(1, 1).Next());
}

TEST(Noise, GaussianHasItsLaw) {
  const NoiseLaw law{NoiseKind::kGaussian, 0.1};
  EXPECT_LT(KolmogorovStatistic(Draws(law), [](double e) { return NormalCdf(e / 0.1); }), 1.95);
}

TEST(Noise, StudentTWithThreeDegreesHasItsLaw) {
  NoiseLaw law{NoiseKind::kStudentT, 2.0};
  law.dof = 3.0;
  const auto cdf = [](double e) {  // closed form for 3 degrees of freedom
    const double t = e / 2.0 / std::sqrt(3.0);
    return 0.5 + (std::atan(t) + t / (1.0 + t * t)) / M_PI;
  };
  EXPECT_LT(KolmogorovStatistic(Draws(law), cdf), 1.95);
}

TEST(Noise, LaplaceHasItsLaw) {
  const NoiseLaw law{NoiseKind::kLaplace, 0.5};
  const auto cdf = [](double e) { return e < 0.0 ? 0.5 * std::exp(e / 0.5) : 1.0 - 0.5 * std::exp(-e / 0.5); };
  EXPECT_LT(KolmogorovStatistic(Draws(law), cdf), 1.95);
}

TEST(Noise, MixtureHasItsLaw) {
  NoiseLaw law{NoiseKind::kMixture, 0.1};
  law.outlier_weight = 0.2;
  law.outlier_scale = 8.0;
  const auto cdf = [](double e) { return 0.8 * NormalCdf(e / 0.1) + 0.2 * NormalCdf(e / 0.8); };
  EXPECT_LT(KolmogorovStatistic(Draws(law), cdf), 1.95);
}

TEST(Noise, IsWhite) {
  const std::vector<double> draws = Draws({NoiseKind::kGaussian, 1.0});
  for (const int lag : {1, 2, 100}) {
    double sum = 0.0;
    for (std::size_t i = static_cast<std::size_t>(lag); i < draws.size(); ++i)
      sum += draws[i] * draws[i - static_cast<std::size_t>(lag)];
    EXPECT_LT(std::abs(sum) / kDraws, 4.0 / std::sqrt(kDraws)) << "lag " << lag;  // four standard errors
  }
}

}  // namespace
}  // namespace armcmc::plant_sim::noise_test
