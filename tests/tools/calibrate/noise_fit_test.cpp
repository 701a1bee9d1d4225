#include "armcmc/calibrate/noise_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "armcmc/noise_model.hpp"

namespace armcmc::calibrate::noise_fit_test {
namespace {

using Draw = std::function<double(std::mt19937_64&)>;

double Normal(std::mt19937_64& rng) { return std::normal_distribution<double>()(rng); }

PackErrors Draws(const Draw& draw, std::size_t packs = 200, std::size_t samples = 60, unsigned seed = 1) {
  std::mt19937_64 rng(seed);
  PackErrors errors(packs, std::vector<double>(samples));
  for (auto& pack : errors)
    for (double& e : pack) e = draw(rng);
  return errors;
}

NoiseSettings Chosen(const PackErrors& errors) {
  const auto scores = CompareLaws(errors, NoiseSettings{});
  return scores[SimplestGoodLaw(scores)].noise;
}

// 12 000 errors: the relative standard error of a scale is about 1 %, that of a shape about 5 %.
constexpr double kScale = 0.03, kShape = 0.2;

TEST(NoiseFit, FindsTheGaussian) {
  const NoiseSettings noise = Chosen(Draws([](auto& rng) { return 0.25 * Normal(rng); }));
  EXPECT_EQ(noise.kind, NoiseKind::kGaussian);
  EXPECT_NEAR(noise.std / 0.25, 1.0, kScale);
}

TEST(NoiseFit, FindsTheLaplace) {
  const NoiseSettings noise = Chosen(Draws([](auto& rng) {
    const double size = std::exponential_distribution<double>(1.0 / 0.07)(rng);
    return std::bernoulli_distribution(0.5)(rng) ? size : -size;
  }));
  EXPECT_EQ(noise.kind, NoiseKind::kLaplace);
  EXPECT_NEAR(noise.std / 0.07, 1.0, kScale);
}

TEST(NoiseFit, FindsTheStudentT) {
  const NoiseSettings noise =
      Chosen(Draws([](auto& rng) { return 1e-6 * std::student_t_distribution<double>(4.0)(rng); }));
  EXPECT_EQ(noise.kind, NoiseKind::kStudentT);
  EXPECT_NEAR(noise.std / 1e-6, 1.0, kScale);
  EXPECT_NEAR(noise.dof / 4.0, 1.0, kShape);
}

TEST(NoiseFit, FindsTheMixture) {
  const NoiseSettings noise = Chosen(
      Draws([](auto& rng) { return (std::bernoulli_distribution(0.08)(rng) ? 12.0 : 1.0) * 3.0 * Normal(rng); }));
  EXPECT_EQ(noise.kind, NoiseKind::kMixture);
  EXPECT_NEAR(noise.std / 3.0, 1.0, kScale);
  EXPECT_NEAR(noise.outlier_weight / 0.08, 1.0, kShape);
  EXPECT_NEAR(noise.outlier_scale / 12.0, 1.0, kShape);
}

TEST(NoiseFit, AFitIsAMaximumOfTheLikelihood) {
  const PackErrors errors = Draws([](auto& rng) { return std::student_t_distribution<double>(3.0)(rng); }, 50);
  std::vector<double> all;
  for (const auto& pack : errors) all.insert(all.end(), pack.begin(), pack.end());
  const auto value = [&all](const NoiseSettings& noise) {
    const NoiseModel model(noise);
    double sum = 0.0;
    for (const double e : all) sum += model.LogDensity(e, noise.std);
    return sum;
  };
  for (const NoiseKind kind : {NoiseKind::kGaussian, NoiseKind::kLaplace, NoiseKind::kStudentT, NoiseKind::kMixture}) {
    const NoiseSettings fit = FitLaw(kind, all, NoiseSettings{});
    for (const double factor : {0.95, 1.05}) {
      NoiseSettings beside = fit;
      beside.std *= factor;
      EXPECT_LT(value(beside), value(fit)) << Name(kind) << ", scale";
      if (kind == NoiseKind::kStudentT) {
        beside = fit, beside.dof *= factor;
        EXPECT_LT(value(beside), value(fit) + 1e-3) << "dof";
      }
      if (kind == NoiseKind::kMixture) {
        beside = fit, beside.outlier_weight *= factor;
        EXPECT_LT(value(beside), value(fit) + 1e-3) << "weight";
        beside = fit, beside.outlier_scale *= factor;
        EXPECT_LT(value(beside), value(fit) + 1e-3) << "wide scale";
      }
    }
  }
}

// A richer law fits noise of the sample; held out it gains nothing, and the simple one is kept.
TEST(NoiseFit, ALawWithMoreNumbersIsNotTakenForNothing) {
  int gaussian = 0;
  for (unsigned seed = 1; seed <= 10; ++seed)
    gaussian += Chosen(Draws(Normal, 40, 50, seed)).kind == NoiseKind::kGaussian ? 1 : 0;
  EXPECT_GE(gaussian, 9);
}

TEST(NoiseFit, CorrelationIsThatOfNeighbours) {
  PackErrors errors = Draws(Normal);
  EXPECT_NEAR(Lag1Correlation(errors), 0.0, 0.03);
  for (auto& pack : errors)
    for (std::size_t i = 1; i < pack.size(); ++i) pack[i] = 0.8 * pack[i - 1] + 0.6 * pack[i];
  EXPECT_NEAR(Lag1Correlation(errors), 0.8, 0.03);
}

}  // namespace
}  // namespace armcmc::calibrate::noise_fit_test
