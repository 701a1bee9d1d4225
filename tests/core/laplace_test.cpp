#include "armcmc/laplace.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <memory>
#include <random>

#include "armcmc/models/registry.hpp"
#include "core/kernel_sets.hpp"

namespace armcmc::laplace_test {
namespace {

struct Problem {
  EstimatorSettings settings;
  NoiseModel noise;
  ParameterSpace space;
  ModeData data;
  LaplaceScratch scratch;
  Gaussian prior;
  Gaussian fit;

  explicit Problem(const EstimatorSettings& s) : settings(s), noise(s.noise[0]), space(s, s.noise[0]) {
    data.weight.fill(1.0);
    prior = {ParamVector::Zero(space.dim), ParamMatrix::Identity(space.dim, space.dim)};
  }
  double Fit(const simd::Kernels& kernels, const ParamVector& start) {
    return LaplaceFit(kernels, FindModel(settings.model), data, noise, space, prior, start, kModeTolerance, &scratch,
                      &fit);
  }
  /// Log of likelihood x prior at u, by the scalar law.
  [[nodiscard]] double Objective(const ParamVector& u) const {
    double sum = -0.5 * (u - prior.mean).dot(prior.precision * (u - prior.mean));
    const double scale = std::exp(space.LogNoiseScale(u.data()));
    for (std::size_t n = 0; n < static_cast<std::size_t>(data.num_samples); ++n) {
      const double power = std::exp2(space.Theta(2, u[2]) * data.feature[0][n]);
      const double f = power * (space.Theta(0, u[0]) + space.Theta(1, u[1]) * data.feature[1][n]);
      sum += noise.LogDensity((data.target[n] - f - noise.settings().mean) * data.weight[n], scale);
    }
    return sum;
  }
};

TEST(LaplaceFit, LinearModelEqualsTheClosedForm) {
  EstimatorSettings settings = BuiltinSettings("soft_actuator");
  settings.noise[0].std = 0.5;
  auto problem = std::make_unique<Problem>(settings);
  std::mt19937_64 g(1);
  std::normal_distribution<double> normal;
  ParamMatrix precision = problem->prior.precision;
  ParamVector right = ParamVector::Zero(2);
  problem->data.num_samples = 80;
  for (std::size_t n = 0; n < 80; ++n) {
    problem->data.feature[0][n] = 1e3 * normal(g);
    problem->data.feature[1][n] = 1e7 * normal(g);
    problem->data.target[n] = 4e-4 * problem->data.feature[0][n] + 6e-9 * problem->data.feature[1][n] + 0.5 * normal(g);
    problem->data.weight[n] = std::exp(-0.02 * static_cast<double>(79 - n));
    // theta = scale u, and the weight multiplies the error.
    ParamVector j(2);
    for (int d = 0; d < 2; ++d)
      j[d] = problem->space.scale[static_cast<std::size_t>(d)] * problem->data.feature[static_cast<std::size_t>(d)][n];
    const double w2 = problem->data.weight[n] * problem->data.weight[n];
    precision += j * j.transpose() * w2 / 0.25;
    right += j * problem->data.target[n] * w2 / 0.25;
  }
  const ParamVector mean = precision.ldlt().solve(right);
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    problem->Fit(*kernels, ParamVector::Zero(2));
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(problem->fit.mean[i], mean[i], 1e-8) << kernels->name;
      for (int j = 0; j < 2; ++j)
        EXPECT_NEAR(problem->fit.precision(i, j), precision(i, j), 1e-8 * std::sqrt(precision(i, i) * precision(j, j)));
    }
  }
}

void FillContact(Problem* problem, double k, double b, double p, double x_from, double x_to, int samples) {
  std::mt19937_64 g(7);
  std::normal_distribution<double> normal(0.0, 0.1);
  problem->data.num_samples = samples;
  for (int i = 0; i < samples; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const double part = samples > 1 ? static_cast<double>(i) / (samples - 1) : 0.0;
    const double x = x_from + (x_to - x_from) * part, v = std::cos(9.0 * part);
    problem->data.feature[0][n] = std::log2(x);
    problem->data.feature[1][n] = v;
    problem->data.target[n] = std::pow(x, p) * (k + b * v) + normal(g);
  }
}

TEST(LaplaceFit, GradientIsZeroAtTheModeOfAContact) {
  for (const NoiseKind kind : {NoiseKind::kGaussian, NoiseKind::kStudentT, NoiseKind::kMixture})
    for (const bool estimate_std : {false, true}) {
      EstimatorSettings settings = BuiltinSettings("hunt_crossley");
      settings.noise[0].kind = kind;
      settings.noise[0].estimate_std = estimate_std;
      auto problem = std::make_unique<Problem>(settings);
      FillContact(problem.get(), 4.0, 2.3, 1.7, 0.2, 1.6, 100);
      const double value = problem->Fit(simd::Best(), ParamVector::Zero(problem->space.dim));
      const ParamVector mode = problem->fit.mean;
      EXPECT_NEAR(value, problem->Objective(mode), 1e-6);
      const ParamMatrix covariance = problem->fit.precision.inverse();
      for (int d = 0; d < problem->space.dim; ++d) {
        const auto i = static_cast<std::size_t>(d);
        EXPECT_GT(mode[d], problem->space.lower[i]);
        EXPECT_LT(mode[d], problem->space.upper[i]);
      }
      // In standard deviations of the posterior: the mode is found to a small part of one.
      ParamVector gradient(problem->space.dim);
      for (int d = 0; d < problem->space.dim; ++d) {
        ParamVector up = mode, down = mode;
        up[d] += 1e-5;
        down[d] -= 1e-5;
        gradient[d] = (problem->Objective(up) - problem->Objective(down)) / 2e-5;
      }
      EXPECT_LT(std::sqrt(gradient.dot(covariance * gradient)), 0.05) << static_cast<int>(kind) << estimate_std;
      EXPECT_NEAR(problem->space.Theta(2, mode[2]), 1.7, 0.1);
    }
}

TEST(LaplaceFit, StaysInsideTheBounds) {
  auto problem = std::make_unique<Problem>(BuiltinSettings("hunt_crossley"));
  FillContact(problem.get(), 30.0, -5.0, 3.5, 0.2, 1.6, 100);  // outside the prior's box in all three
  ParamVector start(3);
  start << 100.0, -100.0, 0.0;
  const double value = problem->Fit(simd::Best(), start);
  EXPECT_TRUE(std::isfinite(value));
  for (int d = 0; d < 3; ++d) {
    const auto i = static_cast<std::size_t>(d);
    EXPECT_GE(problem->fit.mean[d], problem->space.lower[i]);
    EXPECT_LE(problem->fit.mean[d], problem->space.upper[i]);
  }
}

TEST(LaplaceFit, PoorExcitationStaysFiniteAndPositiveDefinite) {
  for (const NoiseKind kind : {NoiseKind::kGaussian, NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture})
    for (const int samples : {1, 3, 100}) {
      EstimatorSettings settings = BuiltinSettings("hunt_crossley");
      settings.noise[0].kind = kind;
      settings.noise[0].estimate_std = samples == 3;
      auto problem = std::make_unique<Problem>(settings);
      FillContact(problem.get(), 4.0, 2.3, 1.7, 1e-8, 1e-7, samples);  // no force to speak of
      EXPECT_TRUE(std::isfinite(problem->Fit(simd::Best(), ParamVector::Zero(problem->space.dim))));
      EXPECT_TRUE(problem->fit.mean.allFinite());
      const Eigen::LLT<ParamMatrix> cholesky(problem->fit.precision);
      EXPECT_EQ(cholesky.info(), Eigen::Success) << static_cast<int>(kind) << " " << samples;
    }
}

TEST(LaplaceFit, WithoutInformationReturnsThePrior) {
  auto problem = std::make_unique<Problem>(BuiltinSettings("hunt_crossley"));
  problem->prior.mean << 0.2, -0.1, 0.3;
  problem->prior.precision *= 4.0;
  FillContact(problem.get(), 4.0, 2.3, 1.7, 1e-8, 1e-7, 10);
  problem->Fit(simd::Best(), ParamVector::Zero(3));
  EXPECT_LT((problem->fit.mean - problem->prior.mean).norm(), 1e-6);
  EXPECT_LT((problem->fit.precision - problem->prior.precision).norm(), 1e-6);
}

}  // namespace
}  // namespace armcmc::laplace_test
