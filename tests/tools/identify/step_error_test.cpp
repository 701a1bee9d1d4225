#include "armcmc/identify/step_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace armcmc::test::step_error_test {
namespace {

using identify::Series;
using identify::StepError;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kDt = 0.1, kNoise = 0.01;

/// x' = k (u - x), sampled every 0.1 s.
Plant Lag(int substeps) {
  PlantDescription plant;
  plant.name = "lag";
  plant.output = "y";
  plant.law = "x";
  plant.signals = {{"u", "1", "drive", ""}, {"y", "1", "position", ""}};
  plant.parameters = {{"k", "1/s", "normal", 10.0, 10.0, 0.0, 1e4}};
  plant.states = {{"x", "1", "", "k*(u - x)", "0", "", substeps}};
  plant.noise.std = kNoise;
  return Plant(plant);
}

Series Steps() {
  Series series;
  series.dt = kDt;
  series.runs = {0};
  series.signals.resize(2);
  for (int n = 0; n < 500; ++n) {
    series.t.push_back(kDt * n);
    series.signals[0].push_back(n % 40 < 20 ? 1.0 : -1.0);
    series.signals[1].push_back(0.0);
  }
  return series;
}

StepError Of(int substeps, double k) {
  return StepErrorOf(Lag(substeps), Steps(), Eigen::VectorXd::Constant(1, k), kNoise);
}

TEST(StepError, NothingIsSaidWhereStepsAreShortEnough) {
  const StepError slow = Of(1, 2.0);
  EXPECT_TRUE(slow.short_enough);
  EXPECT_EQ(slow.enough, 1);
  EXPECT_EQ(StepErrorText(slow, kDt, kNoise), "");
}

// k dt = 2.5: the method is stable, and wrong.
TEST(StepError, StepsThatAreTooLongSayHowManySubstepsAreEnough) {
  const StepError fast = Of(1, 25.0);
  EXPECT_FALSE(fast.short_enough);
  EXPECT_GT(fast.change, kNoise);
  ASSERT_TRUE(fast.enough.has_value());
  EXPECT_GE(*fast.enough, 2);
  EXPECT_LE(*fast.enough, 8);
  EXPECT_THAT(StepErrorText(fast, kDt, kNoise), AllOf(HasSubstr("one step every 0.1 s"), HasSubstr("differs by"),
                                                      HasSubstr("substeps = " + std::to_string(*fast.enough))));
  EXPECT_TRUE(Of(*fast.enough, 25.0).short_enough);
}

// k dt = 4: past the method's limit of 2.78.
TEST(StepError, StepsThatDivergeSaySo) {
  const StepError wild = Of(1, 40.0);
  EXPECT_FALSE(wild.short_enough);
  EXPECT_THAT(StepErrorText(wild, kDt, kNoise), AllOf(HasSubstr("diverges"), HasSubstr("substeps = ")));
}

// k dt = 1000: nothing that a plant file can ask for is enough.
TEST(StepError, WhatIsTooStiffForAnyStepSaysWhatElseToDo) {
  const StepError stiff = Of(2, 1e4);
  EXPECT_FALSE(stiff.enough.has_value());
  EXPECT_THAT(StepErrorText(stiff, kDt, kNoise),
              AllOf(HasSubstr("2 steps every"), HasSubstr("value at which it settles")));
}

}  // namespace
}  // namespace armcmc::test::step_error_test
