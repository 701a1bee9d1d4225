#include "armcmc/gap_watch/gap_evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace armcmc::gap_evidence_test {
namespace {

constexpr int kChecks = 8;

std::array<CheckScore, kMaxGapChecks> Scores(double z, double margin = 0.0) {
  std::array<CheckScore, kMaxGapChecks> scores{};
  for (int c = 0; c < kChecks; ++c) scores[static_cast<std::size_t>(c)] = {z, margin};
  return scores;
}

TEST(GapEvidence, StakesAreTheRateOverAnHour) {
  GapEvidence evidence(kChecks, 0.02);
  for (int block = 0; block < 300; ++block) evidence.Add(Scores(0.0), 1.0 / 300.0);
  EXPECT_NEAR(evidence.stakes(), 0.02, 1e-12);
  evidence.Reset();
  EXPECT_EQ(evidence.stakes(), 0.0);
  EXPECT_EQ(evidence.total(), 0.0);
}

TEST(GapEvidence, EitherSignCountsAndTheMarginIsTakenOff) {
  for (const double z : {4.0, -4.0}) {
    GapEvidence evidence(kChecks, 0.01);
    evidence.Add(Scores(z), 1.0 / 300.0);
    evidence.Add(Scores(z), 1.0 / 300.0);
    EXPECT_GT(evidence.total(), 1.0) << z;
    GapEvidence tolerant(kChecks, 0.01);
    tolerant.Add(Scores(z, 4.0), 1.0 / 300.0);
    tolerant.Add(Scores(z, 4.0), 1.0 / 300.0);
    EXPECT_LT(tolerant.total(), 0.1) << z;
  }
}

TEST(GapEvidence, AGapThatBeginsLateIsFoundSoon) {
  GapEvidence evidence(kChecks, 0.01);
  for (int block = 0; block < 3000; ++block) evidence.Add(Scores(0.0), 1.0 / 300.0);
  int blocks = 0;
  while (evidence.total() < 1.0 && blocks < 100) {
    evidence.Add(Scores(4.0), 1.0 / 300.0);
    ++blocks;
  }
  EXPECT_LE(blocks, 3);
}

TEST(GapEvidence, FalseAlarmsStayBelowTheRate) {
  // Normal scores are the worst that sub-Gaussian ones of variance one can be, up to constants.
  constexpr double kRate = 0.2;
  constexpr int kRuns = 600;
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  int alarms = 0;
  for (int run = 0; run < kRuns; ++run) {
    GapEvidence evidence(kChecks, kRate);
    bool alarm = false;
    for (int block = 0; block < 300; ++block) {
      auto scores = Scores(0.0);
      for (CheckScore& score : scores) score.z = normal(generator);
      evidence.Add(scores, 1.0 / 300.0);
      alarm = alarm || evidence.total() >= 1.0;
    }
    alarms += alarm ? 1 : 0;
  }
  EXPECT_LE(alarms, kRate * kRuns);
  EXPECT_GT(alarms, 0) << "a bound that is never touched is no test of it";
}

TEST(GapEvidence, StaysFinite) {
  GapEvidence evidence(kChecks, 0.01);
  for (int block = 0; block < 10'000; ++block) evidence.Add(Scores(10.0), 1.0);
  EXPECT_TRUE(std::isfinite(evidence.total()));
}

}  // namespace
}  // namespace armcmc::gap_evidence_test
