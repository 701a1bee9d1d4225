// The filters of the bank of Drift, against the same equations with dense matrices of any size.
#include "armcmc/drift_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

namespace armcmc {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Numbers of parameters: those that have code of their own, and others.
class DriftFilterOf : public testing::TestWithParam<int> {
 protected:
  const Eigen::Index n = GetParam();

  VectorXd Vector(Eigen::Index size, double scale = 1.0) {
    return VectorXd::NullaryExpr(size, [&]() { return scale * normal_(random_); });
  }
  MatrixXd Any(Eigen::Index size, double scale = 1.0) {
    return MatrixXd::NullaryExpr(size, size, [&]() { return scale * normal_(random_); });
  }
  MatrixXd Covariance(Eigen::Index size, double scale) {
    const MatrixXd root = Any(size, std::sqrt(scale / static_cast<double>(size)));
    return root * root.transpose() + 0.1 * scale * MatrixXd::Identity(size, size);
  }

  DriftFilter Random() { return FilterOf(0.3, Vector(2 * n), Covariance(2 * n, 0.5)); }
  [[nodiscard]] DriftFilter FilterOf(double weight, const VectorXd& mean, const MatrixXd& covariance) const {
    return {.weight = weight,
            .u = mean.head(n),
            .w = mean.tail(n),
            .uu = covariance.topLeftCorner(n, n),
            .uw = covariance.topRightCorner(n, n),
            .ww = covariance.bottomRightCorner(n, n)};
  }
  [[nodiscard]] VectorXd MeanOf(const DriftFilter& f) const {
    VectorXd mean(2 * n);
    mean << f.u, f.w;
    return mean;
  }
  [[nodiscard]] MatrixXd CovarianceOf(const DriftFilter& f) const {
    MatrixXd joint(2 * n, 2 * n);
    joint << f.uu, f.uw, f.uw.transpose(), f.ww;
    return joint;
  }
  void ExpectIs(const DriftFilter& f, const VectorXd& mean, const MatrixXd& covariance) const {
    EXPECT_LT((MeanOf(f) - mean).norm(), 1e-9 * (1.0 + mean.norm()));
    EXPECT_LT((CovarianceOf(f) - covariance).norm(), 1e-9 * (1.0 + covariance.norm()));
  }

  /// N(mean, covariance) times exp(gradient' (x - centre) - (x - centre)' information (x - centre) / 2), by completing
  /// the square. @return Log of the integral.
  static double Multiplied(const VectorXd& gradient, const MatrixXd& information, const VectorXd& centre,
                           VectorXd* mean, MatrixXd* covariance) {
    const MatrixXd before = covariance->inverse();
    const MatrixXd after = before + information;
    const VectorXd b = before * *mean + gradient + information * centre;
    const VectorXd x = after.ldlt().solve(b);
    const double log = 0.5 * (std::log(before.determinant()) - std::log(after.determinant()) + b.dot(x) -
                              mean->dot(before * *mean) - centre.dot(information * centre)) -
                       gradient.dot(centre);
    *mean = x;
    *covariance = after.inverse();
    return log;
  }

 private:
  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
};

TEST_P(DriftFilterOf, IsMultipliedByTheLikelihoodOfAPack) {
  DriftFilter filter = Random();
  const VectorXd centre = Vector(n);
  const VectorXd a = Vector(n);
  const MatrixXd h = Covariance(n, 20.0);
  MatrixXd information = MatrixXd::Zero(2 * n, 2 * n);
  information.topLeftCorner(n, n) = h;
  VectorXd gradient = VectorXd::Zero(2 * n);
  gradient.head(n) = a;
  VectorXd about = VectorXd::Zero(2 * n);
  about.head(n) = centre;
  VectorXd mean = MeanOf(filter);
  MatrixXd covariance = CovarianceOf(filter);
  const double log = Multiplied(gradient, information, about, &mean, &covariance);
  LocalLikelihood local;
  local.gradient = a;
  local.information = h;
  EXPECT_NEAR(filter.MultiplyBy(local, centre), log, 1e-9 * (1.0 + std::fabs(log)));
  ExpectIs(filter, mean, covariance);
  EXPECT_EQ(filter.weight, 0.3);
}

TEST_P(DriftFilterOf, BecomesThatOfTheEffectiveParametersAndBack) {
  DriftFilter filter = Random();
  const MatrixXd lead = Any(n, 0.2);
  const VectorXd mode = Vector(n);
  const VectorXd of_w = Vector(n);
  const MatrixXd mixed = Any(n, 0.05);
  const MatrixXd information_w = Covariance(n, 3.0);
  MatrixXd map = MatrixXd::Identity(2 * n, 2 * n);
  map.topRightCorner(n, n) = -lead;
  VectorXd mean = map * MeanOf(filter);
  MatrixXd covariance = map * CovarianceOf(filter) * map.transpose();
  MatrixXd information = MatrixXd::Zero(2 * n, 2 * n);
  information.topRightCorner(n, n) = mixed;
  information.bottomLeftCorner(n, n) = mixed.transpose();
  information.bottomRightCorner(n, n) = information_w;
  VectorXd gradient = VectorXd::Zero(2 * n);
  gradient.tail(n) = of_w;
  VectorXd about = VectorXd::Zero(2 * n);
  about.head(n) = mode;
  const double log = Multiplied(gradient, information, about, &mean, &covariance);
  const double found =
      filter.ToEffective({.mode = mode, .lead = lead, .gradient = of_w, .mixed = mixed, .information = information_w});
  EXPECT_NEAR(found, log, 1e-9 * (1.0 + std::fabs(log)));
  ExpectIs(filter, mean, covariance);

  map.topRightCorner(n, n) = lead;
  filter.FromEffective(lead);
  ExpectIs(filter, map * mean, map * covariance * map.transpose());
}

TEST_P(DriftFilterOf, IsTransformedInItsParametersAlone) {
  DriftFilter filter = Random();
  const MatrixXd map_u = Any(n);
  const VectorXd from = Vector(n);
  const VectorXd to = Vector(n);
  MatrixXd map = MatrixXd::Identity(2 * n, 2 * n);
  map.topLeftCorner(n, n) = map_u;
  const MatrixXd covariance = map * CovarianceOf(filter) * map.transpose();
  VectorXd mean = MeanOf(filter);
  mean.head(n) = to + map_u * (mean.head(n) - from);
  filter.Transform(map_u, from, to);
  ExpectIs(filter, mean, covariance);
}

TEST_P(DriftFilterOf, IsPropagatedWithoutData) {
  DriftFilter filter = Random();
  filter.uu *= 0.1;  // far within the variance of P_0
  filter.uw *= 0.1;
  filter.ww *= 0.1;
  const DriftStep step{.phi = 0.9, .b = 0.3, .noise_uu = 0.01, .noise_uw = 0.02, .noise_ww = 0.05};
  const MovingParameters moving{.first = n - 1, .count = 1};
  MatrixXd map = MatrixXd::Identity(2 * n, 2 * n);
  map.topRightCorner(n, n).diagonal().setConstant(step.b);
  map.bottomRightCorner(n, n) *= step.phi;
  MatrixXd covariance = map * CovarianceOf(filter) * map.transpose();
  covariance(n - 1, n - 1) += step.noise_uu;
  covariance(n - 1, 2 * n - 1) += step.noise_uw;
  covariance(2 * n - 1, n - 1) += step.noise_uw;
  covariance(2 * n - 1, 2 * n - 1) += step.noise_ww;
  const VectorXd mean = map * MeanOf(filter);
  filter.Propagate(step, moving);
  ExpectIs(filter, mean, covariance);
}

TEST_P(DriftFilterOf, GrowsNoWiderThanTheInitialPrior) {
  DriftFilter filter = Random();
  filter.uu(0, 0) = 0.9;
  filter.u[0] = 2.0;
  filter.w.setZero();
  const double covariance = filter.uw(0, 0);
  const double velocity = filter.ww(0, 0);
  filter.Propagate({.phi = 1.0, .b = 0.0, .noise_uu = 3.1, .noise_uw = 0.0, .noise_ww = 0.0}, {.first = 0, .count = 1});
  EXPECT_NEAR(filter.uu(0, 0), 1.0, 1e-12);  // of 4
  EXPECT_NEAR(filter.u[0], 0.5, 1e-12);
  EXPECT_NEAR(filter.uw(0, 0), 0.5 * covariance, 1e-12);
  EXPECT_EQ(filter.ww(0, 0), velocity);
}

TEST_P(DriftFilterOf, HasTheVolumeOfWhatMoves) {
  const DriftFilter filter = Random();
  const MatrixXd joint = CovarianceOf(filter);
  EXPECT_NEAR(filter.LogVolume({.first = 0, .count = n}), 0.5 * std::log(joint.determinant()), 1e-9);
  EXPECT_NEAR(filter.LogVolume({}), 0.5 * std::log(joint.topLeftCorner(n, n).determinant()), 1e-9);
  MatrixXd one(n + 1, n + 1);
  const Eigen::Index moving = 2 * n - 1;
  one << joint.topLeftCorner(n, n), joint.col(moving).head(n), joint.row(moving).head(n), joint(moving, moving);
  EXPECT_NEAR(filter.LogVolume({.first = n - 1, .count = 1}), 0.5 * std::log(one.determinant()), 1e-9);
}

TEST_P(DriftFilterOf, AbsorbsTheMomentsOfAnother) {
  DriftFilter filter = Random();
  DriftFilter other = Random();
  other.weight = 0.1;
  const VectorXd apart = MeanOf(other) - MeanOf(filter);
  const VectorXd mean = MeanOf(filter) + 0.25 * apart;
  const MatrixXd covariance =
      0.75 * CovarianceOf(filter) + 0.25 * CovarianceOf(other) + 0.75 * 0.25 * apart * apart.transpose();
  filter.Absorb(&other);
  ExpectIs(filter, mean, covariance);
  EXPECT_NEAR(filter.weight, 0.4, 1e-15);
  EXPECT_EQ(other.weight, 0.0);
}

TEST_P(DriftFilterOf, EmptyOneBecomesTheOtherAndAnEmptyOneAddsNothing) {
  DriftFilter empty;
  DriftFilter other = Random();
  const VectorXd mean = MeanOf(other);
  const MatrixXd covariance = CovarianceOf(other);
  empty.Absorb(&other);
  EXPECT_EQ(empty.weight, 0.3);
  EXPECT_EQ(other.weight, 0.0);
  empty.Absorb(&other);
  EXPECT_EQ(empty.weight, 0.3);
  ExpectIs(empty, mean, covariance);
}

TEST_P(DriftFilterOf, WhatIsNoGaussianIsNotFinite) {
  LocalLikelihood local;
  local.gradient = Vector(n);
  local.information = Covariance(n, 1.0);
  DriftFilter filter = Random();
  filter.uw(n - 1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(std::isfinite(filter.MultiplyBy(local, Vector(n))));
  filter = Random();
  VelocityLikelihood pack{.mode = Vector(n),
                          .lead = ParamMatrix::Zero(n, n),
                          .gradient = Vector(n),
                          .mixed = ParamMatrix::Zero(n, n),
                          .information = ParamMatrix::Zero(n, n)};
  filter.uu.diagonal() *= -1.0;
  EXPECT_FALSE(std::isfinite(filter.ToEffective(pack)));
  filter = Random();
  pack.information.setConstant(std::numeric_limits<double>::infinity());
  EXPECT_FALSE(std::isfinite(filter.ToEffective(pack)));
  filter.uu.setConstant(1.0);
  filter.uu.diagonal().setConstant(-1.0);
  EXPECT_FALSE(std::isfinite(filter.LogVolume({})));
}

INSTANTIATE_TEST_SUITE_P(Parameters, DriftFilterOf, testing::Values(1, 2, 3, 4, 5, 8));

}  // namespace
}  // namespace armcmc
