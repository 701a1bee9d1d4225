#include "armcmc/calibrate/threshold.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "armcmc/forgetting.hpp"

namespace armcmc::calibrate::threshold_test {
namespace {

/// Scores whose tail is exponential above 0.2 with mean excess 0.3.
std::vector<double> Scores(std::size_t n, unsigned seed = 3) {
  std::mt19937_64 rng(seed);
  std::vector<double> scores(n);
  for (double& s : scores) s = 0.2 + std::exponential_distribution<double>(1.0 / 0.3)(rng);
  return scores;
}

TEST(Threshold, IsTheQuantileWhereThereAreEnoughPacks) {
  const ThresholdChoice choice = ChooseThreshold(Scores(20'000), 0.01);
  EXPECT_FALSE(choice.extrapolated);
  EXPECT_NEAR(choice.threshold, 0.2 + 0.3 * std::log(100.0), 0.06);
  EXPECT_NEAR(choice.measured_rate, 0.01, 2e-4);
}

TEST(Threshold, ExtendsTheTailWhereThereAreNot) {
  double sum = 0.0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const ThresholdChoice choice = ChooseThreshold(Scores(400, seed), 1e-4);
    EXPECT_TRUE(choice.extrapolated);
    EXPECT_LE(choice.measured_rate, 0.01);
    sum += choice.threshold;
  }
  // The tail's mean, of 40 excesses, is known to 16 %, the mean of 40 such to 2.5 %.
  EXPECT_NEAR(sum / 40.0, 0.2 + 0.3 * std::log(1e4), 0.2);
}

TEST(Threshold, HasAFloor) {
  std::vector<double> scores = Scores(200);
  for (double& s : scores) s -= 5.0;
  const ThresholdChoice choice = ChooseThreshold(scores, 0.01);
  EXPECT_EQ(choice.threshold, kSmallestThreshold);
  EXPECT_TRUE(choice.at_floor);
}

/// The score is where the decision turns, for every index.
TEST(Threshold, AScoreIsTheThresholdAtWhichTheDecisionTurns) {
  for (const MismatchIndex index : {MismatchIndex::kRms, MismatchIndex::kSignedMean, MismatchIndex::kLogPredictive}) {
    ForgettingSettings settings;
    settings.index = index;
    settings.threshold = 1e4;
    settings.mu = 0.05;
    const NoiseModel noise{NoiseSettings{}};
    const auto data = std::make_unique<ModeData>();
    const auto predictive = std::make_unique<PredictiveMoments>();
    data->num_samples = predictive->num_samples = 40;
    data->pack_share = 0.4;
    for (std::size_t n = 0; n < 40; ++n) data->target[n] = 2.5 + 0.1 * static_cast<double>(n % 7);
    const auto decide = [&](double threshold) {
      settings.threshold = threshold;
      return EvaluateMismatch(settings, noise, 1.0, *data, *predictive);
    };
    const Mismatch never = decide(1e4);
    ModeEstimate mode;
    mode.num_samples = 40;
    mode.zeta = never.zeta;
    mode.zeta_threshold = never.threshold;
    const double score = ThresholdScore(settings, mode, 100);
    EXPECT_GT(score, 0.1) << static_cast<int>(index);
    EXPECT_EQ(decide(score * 1.001).decision, Decision::kReinforcement) << static_cast<int>(index);
    EXPECT_EQ(decide(score * 0.999).decision, Decision::kModification) << static_cast<int>(index);
  }
}

}  // namespace
}  // namespace armcmc::calibrate::threshold_test
