#include "armcmc/forgetting.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>

namespace armcmc::forgetting_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kScale = 0.1;
constexpr MismatchIndex kIndices[] = {MismatchIndex::kSignedMean, MismatchIndex::kRms, MismatchIndex::kLogPredictive};

/// Each law is integrated once: construction takes milliseconds.
const NoiseModel& Law(NoiseKind kind) {
  static const std::array<NoiseModel, 4> laws = [] {
    std::array<NoiseModel, 4> all;
    for (std::size_t i = 0; i < all.size(); ++i) {
      NoiseSettings s;
      s.kind = static_cast<NoiseKind>(i);
      all[i] = NoiseModel(s);
    }
    return all;
  }();
  return laws[static_cast<std::size_t>(kind)];
}

struct Case {
  ForgettingSettings settings;
  NoiseModel noise = Law(NoiseKind::kGaussian);
  ModeData data;
  PredictiveMoments predictive;

  /// Errors in noise scales, against a posterior that is sure of its predictions.
  Case(int samples, const std::function<double(int)>& error) {
    data.num_samples = predictive.num_samples = samples;
    data.weight.fill(1.0);
    for (int i = 0; i < samples; ++i) {
      const auto k = static_cast<std::size_t>(i);
      predictive.mean[k] = std::sin(i);
      data.target[k] = predictive.mean[k] + kScale * error(i);
    }
  }
  [[nodiscard]] Mismatch Evaluate(MismatchIndex index) const {
    ForgettingSettings s = settings;
    s.index = index;
    return EvaluateMismatch(s, noise, kScale, data, predictive);
  }
};

TEST(Mismatch, ConstantErrorHasItsClosedForm) {
  for (const double a : {0.0, 0.4, -0.7, 1.3}) {
    const Case c(100, [a](int) { return a; });
    EXPECT_NEAR(c.Evaluate(MismatchIndex::kSignedMean).zeta, a, 1e-9);
    EXPECT_NEAR(c.Evaluate(MismatchIndex::kRms).zeta, std::fabs(a) - 1.0, 1e-5);
    EXPECT_NEAR(c.Evaluate(MismatchIndex::kLogPredictive).zeta, 0.5 * (a * a - 1.0), 1e-5);
  }
}

// A scale that is 10 % too small makes the index larger by as much: three times that is explained by not knowing it.
TEST(Mismatch, AllowsForANoiseScaleThatIsNotKnown) {
  for (const NoiseKind kind : {NoiseKind::kGaussian, NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture})
    for (const MismatchIndex index : {MismatchIndex::kRms, MismatchIndex::kLogPredictive}) {
      Case c(kMaxPackSamples, [](int) { return 0.0; });
      c.noise = Law(kind);
      const double known = c.Evaluate(index).allowance;
      c.predictive.log_noise_sd = 0.1;
      const double unknown = c.Evaluate(index).allowance;
      // By how much the index moves with log s, from the law's moments.
      const double slope = index == MismatchIndex::kRms ? 1.0 / std::sqrt(Law(kind).deviance_mean()) : 1.0;
      EXPECT_NEAR(std::sqrt(unknown * unknown - known * known), 0.3 * slope, 1e-9);
    }
}

TEST(Mismatch, LambdaAndThresholdHaveTheirClosedForms) {
  // Fifty equal errors a against mu = 0.1, threshold 0.8, lambda at most 0.9. Of the Gaussian law the deviance e^2 has
  // mean 1 and sd sqrt 2, the log density has sd 1 / sqrt 2; three standard deviations of the index are allowed for.
  struct Row {
    MismatchIndex index;
    double error, pack_share, threshold, lambda;  // lambda 0: a modification
  };
  const double signed_mean = 3.0 / std::sqrt(50.0), rms = 0.3, log_density = 0.3;
  for (const Row& row : {Row{MismatchIndex::kSignedMean, 0.1, 1.0, 0.8 + signed_mean, 0.9},
                         Row{MismatchIndex::kSignedMean, 1.0, 1.0, 0.8 + signed_mean, std::exp(signed_mean - 0.9)},
                         Row{MismatchIndex::kSignedMean, -0.8, 1.0, 0.8 + signed_mean, std::exp(signed_mean - 0.9)},
                         Row{MismatchIndex::kSignedMean, 1.33, 1.0, 0.8 + signed_mean, 0.0},
                         Row{MismatchIndex::kSignedMean, -1.13, 1.0, 0.8 + signed_mean, 0.0},
                         // A fit that is better than expected is no reason to forget.
                         Row{MismatchIndex::kRms, 0.0, 1.0, 0.8 + rms, 0.9},
                         Row{MismatchIndex::kRms, 1.9, 1.0, 0.8 + rms, std::exp(rms - 0.8)},
                         Row{MismatchIndex::kRms, -1.9, 1.0, 0.8 + rms, std::exp(rms - 0.8)},
                         Row{MismatchIndex::kRms, 2.19, 1.0, 0.8 + rms, std::exp(rms - 1.09)},
                         Row{MismatchIndex::kRms, 2.21, 1.0, 0.8 + rms, 0.0},
                         Row{MismatchIndex::kLogPredictive, 0.0, 1.0, 0.8 + log_density, 0.9},
                         Row{MismatchIndex::kLogPredictive, 1.6, 1.0, 0.8 + log_density, std::exp(log_density - 0.68)},
                         Row{MismatchIndex::kLogPredictive, 1.9, 1.0, 0.8 + log_density, 0.0},
                         // A quarter of a pack weighs half.
                         Row{MismatchIndex::kRms, 2.21, 0.25, 1.6 + rms, std::exp(0.5 * (rms - 1.11))},
                         Row{MismatchIndex::kRms, 3.01, 0.25, 1.6 + rms, 0.0}}) {
    Case c(50, [&](int) { return row.error; });
    c.settings.threshold = 0.8;
    c.settings.mu = 0.1;
    c.settings.lambda_max = 0.9;
    c.data.pack_share = row.pack_share;
    const Mismatch m = c.Evaluate(row.index);
    const std::string what = "index " + std::to_string(static_cast<int>(row.index)) + ", error " +
                             std::to_string(row.error) + ", share " + std::to_string(row.pack_share);
    EXPECT_NEAR(m.threshold, row.threshold, 1e-5) << what;
    EXPECT_NEAR(m.lambda, row.lambda, 1e-5) << what;
    EXPECT_EQ(m.decision, row.lambda > 0.0 ? Decision::kReinforcement : Decision::kModification) << what;
  }
}

TEST(Mismatch, SignedMeanLetsOppositeErrorsCancelAsThePaperDoes) {
  const Case c(100, [](int i) { return i % 2 == 0 ? 5.0 : -5.0; });
  const Mismatch paper = c.Evaluate(MismatchIndex::kSignedMean);
  EXPECT_NEAR(paper.zeta, 0.0, 1e-9);
  EXPECT_EQ(paper.decision, Decision::kReinforcement);
  EXPECT_EQ(c.Evaluate(MismatchIndex::kRms).decision, Decision::kModification);
  EXPECT_EQ(c.Evaluate(MismatchIndex::kLogPredictive).decision, Decision::kModification);
}

TEST(Mismatch, TrebledErrorIsAModificationByDefault) {
  std::mt19937_64 generator(4);
  std::normal_distribution<double> normal;
  const Case c(100, [&](int) { return 3.0 * normal(generator); });
  EXPECT_EQ(c.Evaluate(MismatchIndex::kRms).decision, Decision::kModification);
  EXPECT_EQ(c.Evaluate(MismatchIndex::kLogPredictive).decision, Decision::kModification);
}

TEST(Mismatch, FewSamplesOfPureNoiseAreNotPunished) {
  std::mt19937_64 generator(5);
  for (const NoiseKind kind : {NoiseKind::kGaussian, NoiseKind::kLaplace, NoiseKind::kStudentT})
    for (const MismatchIndex index : kIndices)
      for (const int samples : {3, 10, 100}) {
        int kept = 0;
        constexpr int kTrials = 300;
        for (int trial = 0; trial < kTrials; ++trial) {
          std::normal_distribution<double> normal;
          std::exponential_distribution<double> exponential;
          std::student_t_distribution<double> student(4.0);
          Case c(samples, [&](int) {
            if (kind == NoiseKind::kLaplace) return (generator() & 1 ? 1.0 : -1.0) * exponential(generator);
            return kind == NoiseKind::kStudentT ? student(generator) : normal(generator);
          });
          c.noise = Law(kind);
          const Mismatch m = c.Evaluate(index);
          kept += m.decision == Decision::kReinforcement && m.lambda > 0.9 ? 1 : 0;
        }
        EXPECT_GE(kept, kTrials * 90 / 100)
            << "noise " << static_cast<int>(kind) << " index " << static_cast<int>(index) << " samples " << samples;
      }
}

TEST(Mismatch, UncertainPredictionsExcuseAnError) {
  Case c(100, [](int) { return 2.5; });
  for (const MismatchIndex index : kIndices) {
    c.predictive.variance.fill(0.0);
    c.predictive.variance_of_mean = 0.0;
    EXPECT_EQ(c.Evaluate(index).decision, Decision::kModification);
    const double sd = 2.5 * kScale;
    c.predictive.variance.fill(sd * sd);
    c.predictive.variance_of_mean = sd * sd;
    EXPECT_EQ(c.Evaluate(index).decision, Decision::kReinforcement) << static_cast<int>(index);
  }
}

TEST(Mismatch, NoiseMeanIsNotAnError) {
  Case c(100, [](int) { return 4.0; });
  NoiseSettings biased;
  biased.mean = 4.0 * kScale;
  c.noise = NoiseModel(biased);
  EXPECT_NEAR(c.Evaluate(MismatchIndex::kSignedMean).zeta, 0.0, 1e-9);
  EXPECT_EQ(c.Evaluate(MismatchIndex::kRms).decision, Decision::kReinforcement);
}

TEST(Mismatch, WhatIsNotFiniteIsAModificationAndLambdaStaysInRange) {
  for (const MismatchIndex index : kIndices)
    for (const double bad : {kNan, kInfinity, -kInfinity, 1e300}) {
      for (int where = 0; where < 4; ++where) {
        Case c(20, [](int) { return 0.1; });
        if (where == 0) c.data.target[7] = bad;
        if (where == 1) c.predictive.mean[7] = bad;
        if (where == 2) c.predictive.variance[7] = std::fabs(bad);
        if (where == 3) c.predictive.variance_of_mean = std::fabs(bad);
        const Mismatch m = c.Evaluate(index);
        EXPECT_GE(m.lambda, 0.0);
        EXPECT_LT(m.lambda, 1.0);
        if (where < 2) {
          EXPECT_EQ(m.decision, Decision::kModification) << static_cast<int>(index) << " " << bad;
          EXPECT_EQ(m.lambda, 0.0);
        }
      }
    }
}

}  // namespace
}  // namespace armcmc::forgetting_test
