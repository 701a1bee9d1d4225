#include "armcmc/drift_factor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <memory>

#include "armcmc/noise_model.hpp"
#include "core/kernel_sets.hpp"
#include "support/packs.hpp"

namespace armcmc::drift_factor_test {
namespace {

constexpr int kSamples = 60;

/// Random errors, levers and velocities in `dim` parameters.
struct Case {
  explicit Case(int dim, test::Normal* random)
      : dim(dim), a(kSamples, dim), c(dim, dim), k(dim, dim), m0(dim), u0(dim) {
    data.num_samples = kSamples;
    data.weight.fill(1.0);
    factor.dim = dim;
    for (int i = 0; i < dim; ++i) {
      m0[i] = 0.5 * (*random)();
      u0[i] = (*random)();
      for (int j = 0; j < dim; ++j) k(i, j) = 0.3 * (*random)();
      for (int n = 0; n < kSamples; ++n) a(n, i) = 0.4 * (*random)();
    }
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(dim, dim, [&] { return 0.7 * (*random)(); });
    c = root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(dim, dim);
  }
  /// What the kernels read; `a` is in units of a noise of this scale.
  void Set(double scale) {
    const Eigen::MatrixXd g = a.transpose() * a;
    const Eigen::MatrixXd root = c.llt().matrixL();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(root.transpose() * g * root);
    const Eigen::MatrixXd whiten = eigen.eigenvectors().transpose() * root.transpose();
    factor.log_scale = std::log(scale);
    for (int i = 0; i < dim; ++i) {
      factor.speed[i] = m0[i];
      factor.place[i] = u0[i];
      factor.gain[i] = eigen.eigenvalues()[i];
      for (int n = 0; n < kSamples; ++n) factor.lever[i][n] = scale * a(n, i);
      for (int j = 0; j < dim; ++j) {
        factor.regression[i][j] = k(i, j);
        factor.information[i][j] = g(i, j);
        factor.whiten[i][j] = whiten(i, j);
      }
    }
  }

  int dim;
  Eigen::MatrixXd a, c, k;
  Eigen::VectorXd m0, u0;
  ModeData data;
  DriftFactor factor;
};

TEST(DriftFactor, IsTheLikelihoodOfAllVelocitiesOverThatOfNone) {
  test::Normal random(11);
  NoiseSettings settings;
  settings.std = 0.2;
  const NoiseModel noise(settings);
  const auto tile = std::make_unique<PredictionTile>();
  for (int dim = 1; dim <= kMaxParams; ++dim) {
    const auto one = std::make_unique<Case>(dim, &random);
    one->Set(settings.std);
    std::array<std::array<double, kTileLanes>, kMaxParams> u{};
    std::array<const double*, kMaxParams> rows{};
    for (std::size_t d = 0; d < kMaxParams; ++d) rows[d] = u[d].data();
    for (auto& row : u)
      for (double& v : row) v = random();
    for (std::size_t n = 0; n < kSamples; ++n) {
      one->data.target[n] = random();
      for (double& f : tile->value[n]) f = one->data.target[n] - settings.std * 1.5 * random();
    }
    alignas(64) std::array<double, kTileLanes> log_scale{};
    for (double& v : log_scale) v = std::log(settings.std) + 0.3 * random();
    for (const simd::Kernels* kernels : test::RunnableKernels()) {
      std::array<double, kTileLanes> out{};
      out.fill(3.0);
      LeverTile levers;
      std::array<double, kTileLanes> log_likelihood{};
      kernels->lever_sums(one->factor, noise, one->data, *tile, log_scale.data(), &levers, log_likelihood.data());
      kernels->apply_drift(one->factor, levers, log_scale.data(), rows.data(), 0, out.data());
      for (std::size_t lane = 0; lane < kTileLanes; ++lane) {
        Eigen::VectorXd at(dim), e(kSamples);
        for (int d = 0; d < dim; ++d) at[d] = u[static_cast<std::size_t>(d)][lane];
        for (int n = 0; n < kSamples; ++n)
          e[n] = (one->data.target[static_cast<std::size_t>(n)] - tile->value[static_cast<std::size_t>(n)][lane]) /
                 std::exp(log_scale[lane]);
        const Eigen::MatrixXd a = one->a * (settings.std / std::exp(log_scale[lane]));
        const Eigen::VectorXd moved = e + a * (one->m0 + one->k * (at - one->u0));
        const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(kSamples, kSamples) + a * one->c * a.transpose();
        const double expected = -0.5 * moved.dot(covariance.llt().solve(moved)) -
                                0.5 * std::log(covariance.determinant()) + 0.5 * e.squaredNorm();
        EXPECT_NEAR(std::log(out[lane] / 3.0), expected, 1e-9 * (1.0 + std::fabs(expected)))
            << kernels->name << ", " << dim;
      }
    }
  }
}

TEST(DriftFactor, LeversSumTheScoresOfEveryNoiseLaw) {
  test::Normal random(12);
  const auto tile = std::make_unique<PredictionTile>();
  const auto one = std::make_unique<Case>(3, &random);
  one->Set(1.0);
  for (const NoiseKind kind : {NoiseKind::kGaussian, NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture}) {
    NoiseSettings settings;
    settings.kind = kind;
    settings.std = 0.2;
    const NoiseModel noise(settings);
    for (std::size_t n = 0; n < kSamples; ++n) {
      one->data.target[n] = random();
      one->data.weight[n] = 0.5 + 0.4 * std::sin(static_cast<double>(n));
      for (double& f : tile->value[n]) f = one->data.target[n] - settings.std * (n % 9 == 0 ? 12.0 : 1.5) * random();
    }
    alignas(64) std::array<double, kTileLanes> log_scale{};
    for (double& v : log_scale) v = std::log(settings.std) + 0.3 * random();
    for (const simd::Kernels* kernels : test::RunnableKernels()) {
      LeverTile levers;
      alignas(64) std::array<double, kTileLanes> together{}, alone{};
      kernels->lever_sums(one->factor, noise, one->data, *tile, log_scale.data(), &levers, together.data());
      kernels->log_likelihood(noise, one->data, *tile, log_scale.data(), alone.data());
      for (std::size_t lane = 0; lane < kTileLanes; ++lane) {
        EXPECT_NEAR(together[lane], alone[lane], 1e-6 * std::fabs(alone[lane]));
        for (int d = 0; d < 3; ++d) {
          double expected = 0.0, size = 0.0;
          for (std::size_t n = 0; n < kSamples; ++n) {
            const double e = (one->data.target[n] - tile->value[n][lane]) * one->data.weight[n];
            const double term = one->factor.lever[d][n] * noise.SquareWeight(e, std::exp(log_scale[lane])) * e;
            expected += term;
            size += std::fabs(term);
          }
          EXPECT_NEAR(levers.value[d][lane], expected, 1e-6 * size)
              << kernels->name << ", law " << static_cast<int>(kind);
        }
      }
    }
  }
}

}  // namespace
}  // namespace armcmc::drift_factor_test
