// Plants with priors about a fit.
#include "armcmc/ladder/tuned.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/ladder/made_data.hpp"

namespace armcmc::test::tuned_test {
namespace {

/// The axis, of M = 100 kg and Fv = 180 N s/m, fitted and tuned where Fv may not be less than `least`.
ladder::TunedPlant TunedAxis(double least) {
  PlantDescription description = AxisPlant();
  for (ParameterDescription& p : description.parameters)
    if (p.name == "Fv") p.lower = least;
  ladder::Dataset data = AxisData([](const AxisSample&) { return 0.0; });
  const auto plant = std::make_shared<const Plant>(description);
  const ladder::Trial trial = ladder::FitAlone(plant, &data);
  return ladder::Tuned(description, description.parameters.size(), trial, data.training);
}

TEST(Tuned, WhatTheFitPressesAgainstABoundIsAConstant) {
  const ladder::TunedPlant pressed = TunedAxis(185.0);
  EXPECT_THAT(pressed.held, ::testing::ElementsAre("Fv"));
  ASSERT_EQ(pressed.plant.constants.size(), 1U);
  EXPECT_NEAR(pressed.plant.constants[0].value, 185.0, 0.01);
  EXPECT_NE(pressed.program, nullptr) << pressed.why_not;
}

TEST(Tuned, WhatIsNearABoundThatTheDataTellItFromStaysAParameter) {
  const ladder::TunedPlant free = TunedAxis(178.0);
  EXPECT_THAT(free.held, ::testing::IsEmpty());
  for (const ParameterDescription& p : free.plant.parameters)
    if (p.name == "Fv") {
      EXPECT_NEAR(p.mean, 180.0, 1.5);
      EXPECT_LT(p.sd, 3.0);
    }
}

}  // namespace
}  // namespace armcmc::test::tuned_test
