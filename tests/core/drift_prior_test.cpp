// The prior of a pack where parameters may drift.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "armcmc/density_fit.hpp"
#include "armcmc/drift.hpp"
#include "core/estimator_rig.hpp"
#include "simd/kernels.hpp"

namespace armcmc::drift_prior_test {
namespace {

/// A bank that has learnt from nothing yet, around a Gaussian posterior of the contact's parameters.
class Bank {
 public:
  explicit Bank(double share)
      : settings_(BuiltinSettings("hunt_crossley")),
        space_(settings_, settings_.noise[0]),
        noise_(settings_.noise[0]),
        normal_(MarginalTable::Normal()),
        drift(simd::Best(), 0, space_, noise_, share, Drift::MakeScratch()) {
    posterior.valid = posterior.informed = true;
    posterior.num_blocks = 1;
    posterior.weight = {1.0, 0.0};
    posterior.mean = ParamVector::Zero(3);
    posterior.mean << 0.4, -0.1, 0.2;
    posterior.covariance = ParamMatrix::Zero(3, 3);
    posterior.covariance << 0.04, -0.03, 0.004, -0.03, 0.05, 0.001, 0.004, 0.001, 0.002;
    SetElliptic(posterior.mean, posterior.covariance, 1.0, &normal_, &posterior.block[0]);
    scratch_ = std::make_unique<LaplaceScratch>();
    LearnAgain();
  }

  void LearnAgain() { drift.Learn(data, posterior, {}, Drift::Part::kRest, false, true, scratch_.get()); }

  bool FindEnd(const Drift::Draws& draws, double* p_drifted) {
    return drift.FindEnd(data, posterior.mean, 0.0, draws, p_drifted, scratch_.get(), &end);
  }

  const PosteriorMemory& Carry() { return drift.Carry(data, posterior, scratch_.get()); }

 private:
  EstimatorSettings settings_;
  ParameterSpace space_;
  NoiseModel noise_;
  MarginalTable normal_;
  std::unique_ptr<LaplaceScratch> scratch_;

 public:
  Drift drift;
  PosteriorMemory posterior;
  ModeData data;
  std::array<EndOfPack, kMaxParams> end;
};

TEST(DriftPrior, IsRestAndDriftWithTheirShares) {
  Bank bank(0.3);
  bank.data.time_s = bank.data.duration_s = 2.0;
  const PosteriorMemory& carried = bank.Carry();
  ASSERT_TRUE(bank.drift.Splits(carried));
  ASSERT_EQ(carried.num_blocks, 2);
  EXPECT_EQ(bank.drift.drifting_block(), 1);
  EXPECT_NEAR(carried.weight[0], 0.7, 1e-12);
  EXPECT_NEAR(bank.drift.share(), 0.3, 1e-12);
  // Rest is as it was; drift as wide as the mean over its hypotheses of an integrated Ornstein-Uhlenbeck process.
  double grown = 0.0;
  for (int h = 1; h < Drift::NumHypotheses(3); ++h) {
    const Drift::Hypothesis law = Drift::Of(h, 1.0, 3);
    const double t = law.persistence;
    if (law.Moves(0)) grown += law.prior * 2.0 * law.rate * law.rate * t * (2.0 - t * (1.0 - std::exp(-2.0 / t)));
  }
  const ParamMatrix rest = CovarianceOf(carried.block[0]), drift = CovarianceOf(carried.block[1]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(rest(i, j), bank.posterior.covariance(i, j), 1e-6);
      // Pulled back to P_0 by what was lost: by the fastest walk a fifth of its growth.
      EXPECT_NEAR(drift(i, j) - bank.posterior.covariance(i, j), i == j ? grown : 0.0, 0.25 * grown) << i << j;
    }
}

TEST(DriftPrior, WhatStopsBetweenTwoPacksHasMovedUntilThen) {
  constexpr double kShare = 0.3, kGap = 1.5, kDuration = 0.5;
  Bank bank(kShare);
  bank.data.time_s = kGap + kDuration;
  bank.data.duration_s = kDuration;
  const PosteriorMemory& carried = bank.Carry();
  ASSERT_EQ(carried.num_blocks, 2);
  const double switched = -std::expm1(-Drift::kSwitching * (kGap + kDuration));
  const double stopped = kShare * switched * (1.0 - kShare);
  const double rested = (1.0 - kShare) * (1.0 - switched * kShare);
  const ParamMatrix rest = CovarianceOf(carried.block[0]);
  for (int d = 0; d < 3; ++d) {
    double speed = 0.0;  // mean square
    for (int h = 1; h < Drift::NumHypotheses(3); ++h) {
      const Drift::Hypothesis law = Drift::Of(h, 1.0, 3);
      if (law.Moves(d)) speed += law.prior * law.rate * law.rate;
    }
    // The time until then is uniform in the gap: its mean square is a third.
    const double moved = stopped / (stopped + rested) * speed * kGap * kGap / 3.0;
    EXPECT_NEAR(rest(d, d) - bank.posterior.covariance(d, d), moved, 1e-3 * moved) << d;
  }
}

TEST(DriftPrior, DensitiesAreThoseOfTheirDraws) {
  Bank bank(0.3);
  bank.data.time_s = 1.0;
  const PosteriorMemory& carried = bank.Carry();
  ASSERT_EQ(carried.num_blocks, 2);
  test::Normal random(3);
  // E[g(u) / p(u)] = 1 of draws from p, for any density g inside it.
  for (std::size_t b = 0; b < 2; ++b) {
    const DensityBlock& block = carried.block[b];
    const ParamVector mean = MeanOf(block);
    const ParamMatrix precision = Inverse(CovarianceOf(block)) * 1.3;
    const double norm = std::sqrt(Determinant(precision) / std::pow(2.0 * M_PI, 3.0));
    constexpr int kDraws = 20'000;
    double sum = 0.0;
    for (int k = 0; k < kDraws; ++k) {
      const std::array<double, 3> uniforms{random.Uniform(), random.Uniform(), random.Uniform()};
      std::array<double, 3> u{};
      block.Draw(uniforms.data(), u.data());
      const ParamVector apart = ParamVector(Eigen::Map<const Eigen::Vector3d>(u.data())) - mean;
      sum += norm * std::exp(-0.5 * apart.dot(precision * apart)) / block.Density(u.data());
    }
    EXPECT_NEAR(sum / kDraws, 1.0, 0.02) << b;
  }
}

TEST(DriftPrior, IsThePosteriorItselfWhereDriftIsImprobable) {
  Bank bank(0.5 * Drift::kNegligible);
  bank.data.time_s = bank.data.duration_s = 0.1;
  const PosteriorMemory& rests = bank.Carry();
  EXPECT_FALSE(bank.drift.Splits(rests));
  ASSERT_EQ(rests.num_blocks, 1);
  // With the moments that the bank has, which are those of the posterior here.
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(rests.mean[i], bank.posterior.mean[i], 1e-12);
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(rests.covariance(i, j), bank.posterior.covariance(i, j), 1e-12);
  }
  const std::array<double, 3> u{0.5, -0.3, 0.25};
  EXPECT_NEAR(rests.block[0].Density(u.data()) / bank.posterior.block[0].Density(u.data()), 1.0, 1e-9);
  Bank never(0.0);
  never.data.time_s = 1e6;
  EXPECT_EQ(&never.Carry(), &never.posterior);
}

TEST(DriftPrior, KeepsWhatMayHaveChangedBesideRestAndDrift) {
  Bank bank(0.3);
  PosteriorMemory& last = bank.posterior;
  last.num_blocks = 2;
  last.weight = {0.9, 0.1};
  ParamVector changed = last.mean;
  changed[0] += 3.0;
  SetElliptic(changed, last.covariance, 1.0, &MarginalTable::Normal(), &last.block[1]);
  bank.LearnAgain();
  bank.data.time_s = 1.0;
  const PosteriorMemory& carried = bank.Carry();
  ASSERT_TRUE(bank.drift.Splits(carried));
  ASSERT_EQ(carried.num_blocks, 3);
  EXPECT_NEAR(carried.weight[0], 0.9 * 0.7, 1e-12);
  EXPECT_NEAR(carried.weight[1], 0.9 * 0.3, 1e-12);
  EXPECT_NEAR(carried.weight[2], 0.1, 1e-12);
  const ParamVector mean = MeanOf(carried.block[2]);
  const ParamMatrix covariance = CovarianceOf(carried.block[2]);
  const ParamMatrix whole = carried.covariance;
  for (int d = 0; d < 3; ++d) {
    EXPECT_NEAR(mean[d], changed[d], 1e-6);
    // Drift may have set in there, too.
    EXPECT_NEAR(covariance(d, d), whole(d, d), 1e-6);
    EXPECT_GT(covariance(d, d), last.covariance(d, d));
  }
}

/// Draws of equal weight about `mean`.
struct SomeDraws {
  static constexpr std::size_t kCount = 4096;
  explicit SomeDraws(const ParamVector& mean) {
    std::mt19937_64 g(5);
    std::normal_distribution<double> normal;
    for (int d = 0; d < 3; ++d)
      for (std::size_t k = 0; k < kCount; ++k) u[static_cast<std::size_t>(d)].push_back(mean[d] + 0.2 * normal(g));
  }

  Drift::Draws View() {
    return {.count = kCount,
            .u = {u[0].data(), u[1].data(), u[2].data()},
            .weight = weight.data(),
            .log_likelihood = log_likelihood.data(),
            .share = share.data(),
            .part = Drift::Part::kDrift,
            .of_part = true,
            .scratch = scratch.data()};
  }

  std::array<std::vector<double>, 3> u;
  std::vector<double> weight = std::vector<double>(kCount, 1.0 / kCount), log_likelihood = std::vector<double>(kCount),
                      share = std::vector<double>(kCount, 0.5), scratch = std::vector<double>(kCount);
};

// Draws of drift whose likelihood is three times what the expansion says of it, by the odds that they have of drift.
TEST(DriftPrior, OddsOfDriftAreCorrectedByTheDraws) {
  Bank bank(0.3);
  bank.data.time_s = 2.0;
  ASSERT_TRUE(bank.drift.Splits(bank.Carry()));
  SomeDraws some(ParamVector::Zero(3));
  for (std::size_t k = 0; k < SomeDraws::kCount; ++k) {
    some.share[k] = k % 2 == 0 ? 0.1 : 0.8;
    some.log_likelihood[k] = k % 2 == 0 ? 0.0 : std::log(3.0);  // without samples the expansion is flat
  }
  Drift::Draws draws = some.View();
  double p_drifted = 0.5;
  EXPECT_TRUE(bank.FindEnd(draws, &p_drifted));
  const double actual = 0.45 / 0.55, expanded = (3.0 * 0.1 + 0.8) / (3.0 * 0.9 + 0.2);
  const double odds = 0.3 / 0.7 * actual / expanded;
  EXPECT_NEAR(p_drifted, odds / (1.0 + odds), 1e-6);
  // What has changed is apart: then the bank has the odds alone.
  draws.of_part = false;
  draws.apart = true;
  EXPECT_TRUE(bank.FindEnd(draws, &p_drifted));
  EXPECT_NEAR(p_drifted, 0.3, 1e-6);
}

// Two percent of P_0 in the bank: its outermost quantiles are those of that, and its variance grows by it.
TEST(DriftPrior, WhatMayHaveChangedJoinsTheBank) {
  constexpr double kShare = 0.02;
  std::array<double, 2> tail{}, variance{};
  for (const bool changed : {false, true}) {
    Bank bank(0.3);
    bank.data.time_s = 0.1;
    ASSERT_TRUE(bank.drift.Splits(bank.Carry()));
    if (changed) bank.drift.AddChanged(kShare);
    SomeDraws some(bank.posterior.mean);
    double p_drifted = 0.3;
    ASSERT_TRUE(bank.FindEnd(some.View(), &p_drifted));
    std::vector<double> v = some.u[2];
    std::sort(v.begin(), v.end());
    tail[changed] = bank.end[2](v[SomeDraws::kCount - SomeDraws::kCount / 1000]);
    double sum = 0.0, square = 0.0;
    for (const double effective : v) {
      const double u = bank.end[2](effective);
      sum += u;
      square += u * u;
    }
    sum /= SomeDraws::kCount;
    variance[changed] = square / SomeDraws::kCount - sum * sum;
  }
  const double sd = std::sqrt(0.002), mean = 0.2;  // of the third parameter
  EXPECT_NEAR(tail[0], mean + 3.1 * sd, 0.5 * sd);
  EXPECT_NEAR(tail[1], 1.64, 0.3) << "where P_0 has 5 % beyond";
  EXPECT_NEAR(variance[0], sd * sd, 0.1 * sd * sd);
  EXPECT_NEAR(variance[1], variance[0] + kShare, 0.3 * kShare) << "less what the bounds of p cut off";
}

TEST(DriftPrior, NeverGetsWiderThanTheInitialOne) {
  for (const double hours : {0.01, 1.0, 1e6}) {
    Bank bank(0.9);
    bank.data.time_s = 3600.0 * hours;
    const PosteriorMemory& carried = bank.Carry();
    ASSERT_TRUE(bank.drift.Splits(carried));
    const ParamMatrix c = CovarianceOf(carried.block[static_cast<std::size_t>(bank.drift.drifting_block())]);
    for (int d = 0; d < 3; ++d) {
      EXPECT_LT(c(d, d), 1.1) << hours;
      EXPECT_GT(c(d, d), hours > 1e3 ? 0.9 : 0.0);
    }
  }
}

}  // namespace
}  // namespace armcmc::drift_prior_test
