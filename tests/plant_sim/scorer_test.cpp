#include "armcmc/plant_sim/scorer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "builtin_scenario.hpp"

namespace armcmc::plant_sim::scorer_test {
namespace {

ReceivedEstimate Contact(std::int64_t seq, double arrival_s, Theta theta) {
  ReceivedEstimate estimate;
  estimate.seq = seq;
  estimate.arrival_s = arrival_s;
  estimate.known[0] = true;
  estimate.theta[0] = theta;
  return estimate;
}

TEST(Scorer, APerfectEstimateOfEveryPackLeavesOnlyTheWaitForTheFirst) {
  const Scenario scenario = BuiltinScenario("hunt_crossley_paper");
  Scorer scorer(scenario, 3);
  for (std::int64_t k = 1; k <= 200; ++k) {
    const double t = 0.1 * static_cast<double>(k);
    scorer.Add(Contact(k, t + 0.02, {4.0, 2.3, 1.7}));
    scorer.ScoreThrough(100 * k);
  }
  const Score later = scorer.Result(Convention::kOnePackLater);
  const Score arrival = scorer.Result(Convention::kFromArrival);
  EXPECT_EQ(later.samples, 20'001);
  EXPECT_EQ(later.modes[0][0].mae_active, 0.0);
  EXPECT_EQ(later.modes[0][2].final_value, 1.7);
  // Shown from sample 200 on; from sample 121 on, the first after its arrival.
  EXPECT_EQ(later.modes[0][0].samples - later.modes[0][0].active_samples, 200);
  EXPECT_EQ(arrival.modes[0][0].samples - arrival.modes[0][0].active_samples, 121);
  EXPECT_DOUBLE_EQ(later.modes[0][0].mae, 4.0 * 200 / static_cast<double>(later.modes[0][0].samples));
  // The noise alone: 0.1 N over 20 001 samples, within four standard errors; and a little for the wait.
  EXPECT_NEAR(later.target_noisy_l2, 0.1 * std::sqrt(20'001.0), 0.3);
}

TEST(Scorer, WherePacksOverlapAnEstimateIsShownFromTheEndOfTheNextPackOn) {
  Scenario scenario = BuiltinScenario("hunt_crossley_paper");
  scenario.pack_stride = 10;
  Scorer scorer(scenario, 3);
  scorer.Add(Contact(1, 0.1025, {4.0, 2.3, 1.7}));  // of the samples up to 0.1 s
  scorer.ScoreThrough(150);
  const auto unknown = [&scorer](Convention convention) {
    const ParameterScore score = scorer.Result(convention).modes[0][0];
    return score.samples - score.active_samples;
  };
  EXPECT_EQ(unknown(Convention::kOnePackLater) - unknown(Convention::kFromArrival), 7) << "from 110 on, and from 103";
}

TEST(Scorer, CoverageOfPacksThatOverlapComparesWithTheTruthAtTheirEnd) {
  Scenario scenario = BuiltinScenario("hunt_crossley_step");  // K halves at 8 s
  scenario.pack_stride = 10;
  Scorer scorer(scenario, 3);
  for (const std::int64_t seq : {790, 791}) {  // to 7.99 s, and to 8 s
    ReceivedEstimate estimate = Contact(seq, 9.0, {4.0, 2.3, 1.7});
    estimate.interval_mode = 0;
    estimate.lo = {3.9, 2.2, 1.6};
    estimate.hi = {4.1, 2.4, 1.8};
    scorer.Add(estimate);
  }
  EXPECT_EQ(scorer.Coverage(0), 0.5);
}

TEST(Scorer, ScoresTheShareOfContactOfThePaper) {
  Scorer scorer(BuiltinScenario("hunt_crossley_paper"), 1);
  scorer.ScoreThrough(20'000);
  const Score score = scorer.Result(Convention::kOnePackLater);
  EXPECT_NEAR(static_cast<double>(score.in_mode_samples) / 20'001.0, 0.693, 5e-4);
  EXPECT_EQ(score.target_rel_l2, 1.0);  // nothing known: the prediction is 0
  // Out of contact there is no force, and 0 is right.
  EXPECT_GT(score.target_mae_in_mode, 1.0);
  EXPECT_NEAR(score.target_mae_overall * 20'001.0,
              score.target_mae_in_mode * static_cast<double>(score.in_mode_samples), 1e-6);
  EXPECT_NEAR(score.modes[0][1].mae, 2.3, 1e-11);
  EXPECT_TRUE(std::isnan(score.modes[0][1].mae_active));
  EXPECT_TRUE(std::isnan(scorer.Coverage(0)));
}

TEST(Scorer, ScoresAConstantErrorAsItsSize) {
  Scorer scorer(BuiltinScenario("hunt_crossley_paper"), 1);
  scorer.Add(Contact(1, 0.11, {4.5, 2.2, 1.7}));
  scorer.ScoreThrough(20'000);
  const Score score = scorer.Result(Convention::kFromArrival);
  EXPECT_NEAR(score.modes[0][0].mae_active, 0.5, 1e-12);
  EXPECT_NEAR(score.modes[0][1].mae_active, 0.1, 1e-12);
  EXPECT_NEAR(score.modes[0][0].rel_active, 0.125, 1e-12);
}

TEST(Scorer, NeverShowsAnEstimateBeforeItArrived) {
  Scorer scorer(BuiltinScenario("hunt_crossley_paper"), 1);
  scorer.Add(Contact(1, 0.5, {4.0, 2.3, 1.7}));
  scorer.ScoreThrough(500);
  EXPECT_EQ(scorer.Result(Convention::kOnePackLater).modes[0][0].active_samples, 0);
  scorer.ScoreThrough(501);
  EXPECT_EQ(scorer.Result(Convention::kOnePackLater).modes[0][0].active_samples, 1);
}

TEST(Scorer, AnOlderEstimateThatComesLaterReplacesNothing) {
  Scorer scorer(BuiltinScenario("hunt_crossley_paper"), 1);
  scorer.Add(Contact(2, 0.25, {4.0, 2.3, 1.7}));
  scorer.Add(Contact(1, 0.26, {9.0, 9.0, 9.0}));
  scorer.ScoreThrough(1'000);
  EXPECT_EQ(scorer.Result(Convention::kFromArrival).modes[0][0].mae_active, 0.0);
}

TEST(Scorer, FollowsAStepOfTheTruth) {
  Scorer scorer(BuiltinScenario("hunt_crossley_step"), 1);
  scorer.Add(Contact(1, 0.0, {4.0, 2.3, 1.7}));
  scorer.ScoreThrough(8'000);
  const Score before = scorer.Result(Convention::kFromArrival);
  EXPECT_NEAR(before.modes[0][0].mae_active * static_cast<double>(before.modes[0][0].active_samples), 2.0, 1e-9);
}

TEST(Scorer, CountsTheIntervalsThatHoldTheTruthOfTheirTime) {
  Scorer scorer(BuiltinScenario("hunt_crossley_step"), 1);
  const auto add = [&scorer](std::int64_t seq, double k, double b) {
    ReceivedEstimate estimate = Contact(seq, 0.1 * static_cast<double>(seq), {3.0, 2.3, 1.7});
    estimate.interval_mode = 0;
    estimate.lo = {k - 0.1, b - 0.05, 1.6};
    estimate.hi = {k + 0.1, b + 0.05, 1.8};
    scorer.Add(estimate);
  };
  add(10, 4.0, 2.45);  // K is 4 here,
  add(79, 4.0, 2.15);  // and B is always 2.3: above this interval, below the others.
  add(80, 4.0, 2.45);  // K is 2 from the end of this pack on.
  add(90, 2.0, 2.45);
  EXPECT_DOUBLE_EQ(scorer.Coverage(0), 0.75);
  EXPECT_DOUBLE_EQ(scorer.Coverage(1), 0.0);
  EXPECT_DOUBLE_EQ(scorer.Coverage(2), 1.0);
  EXPECT_EQ(scorer.num_intervals(), 4);
}

TEST(Scorer, ScoresEachValveOfTheActuatorWhileItActs) {
  Scorer scorer(BuiltinScenario("soft_actuator_paper"), 1);
  ReceivedEstimate estimate;
  estimate.seq = 1;
  estimate.arrival_s = 0.1;
  estimate.known = {true, true, false, false};
  estimate.theta[0] = {4.061090e-4 * 1.01, 6.12e-9};
  estimate.theta[1] = {-2.901175e-4 * 1.02, -1.9e-9};
  scorer.Add(estimate);
  scorer.ScoreThrough(20'000);
  const Score score = scorer.Result(Convention::kFromArrival);
  EXPECT_NEAR(score.modes[0][0].rel_active, 0.01, 1e-8);
  EXPECT_NEAR(score.modes[1][0].rel_active, 0.02, 1e-8);
  EXPECT_EQ(score.modes[1][0].samples, 9'000);
}

}  // namespace
}  // namespace armcmc::plant_sim::scorer_test
