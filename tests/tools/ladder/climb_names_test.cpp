// Hidden effects that the ladder names.
#include "armcmc/ladder/climb.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "armcmc/support/plant_file.hpp"
#include "support/paths.hpp"
#include "tools/ladder/climb_rig.hpp"
#include "tools/ladder/made_data.hpp"

namespace armcmc::ladder::climbs::climb_names_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Climb, NamesTheSimplestThatExplainsItAndStops) {
  // Asymmetric friction holds dry friction as a special case.
  const Ladder ladder = ClimbWith(kSome, test::AxisData([](const AxisSample& s) { return 12.0 * Sign(s.v); }));
  ASSERT_EQ(ladder.rungs.size(), 2u);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("coulomb_friction"));
  EXPECT_THAT(NamesOf(ladder.rungs[1]), IsEmpty());
  EXPECT_TRUE(ladder.complete);
  EXPECT_GT(ladder.rungs[0].probability, 0.95);
  EXPECT_FALSE(ladder.rungs[0].provisional);
  const Eigen::VectorXd& theta = ladder.final_trial.fit.theta;
  ASSERT_EQ(theta.size(), 4);
  EXPECT_NEAR(theta[0], 100.0, 1.0);
  EXPECT_NEAR(theta[3], 12.0, 0.5);
}

TEST(Climb, NamesTwoEffectsOneAfterTheOther) {
  const Ladder ladder = ClimbWith(
      kSome, test::AxisData([](const AxisSample& s) { return 15.0 * Sign(s.v) + 60000.0 * s.q * s.q * s.q; }));
  ASSERT_EQ(ladder.rungs.size(), 3u);
  std::vector<std::string> names = NamesOf(ladder.rungs[0]);
  for (const std::string& name : NamesOf(ladder.rungs[1])) names.push_back(name);
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("coulomb_friction", "cubic_stiffness"));
  EXPECT_TRUE(ladder.complete);
}

TEST(Climb, TheSamePhysicsByAnotherFormulaHasTheSameName) {
  const Ladder ladder =
      ClimbWith(kSome, test::AxisData([](const AxisSample& s) { return 20.0 * std::tanh(s.v / 0.02); }));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("coulomb_friction"));
}

TEST(Climb, FindsAFrequencyThatThePriorDoesNotTell) {
  const Ladder ladder =
      ClimbWith(kSome, test::AxisData([](const AxisSample& s) { return 6.0 * std::sin(s.q / 0.004); }));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("cogging"));
}

TEST(Climb, WhatIsSmallBesideANameAndIsNoErrorOfItHasANameToo) {
  double before = 0.0;
  const Dataset data = RotaryData([&](double angle) {
    const double speed = (angle - before) / 0.01, friction = 9.0 * std::tanh(speed / 1.5);
    before = angle;
    return 120.0 * std::sin(angle + 0.3) + friction;
  });
  const Ladder ladder = ClimbWith({"gravity_load", "baseline_tilt", "coulomb_friction"}, data, RotaryPlant());
  ASSERT_GE(ladder.rungs.size(), 2u);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("gravity_load"));
  EXPECT_THAT(NamesOf(ladder.rungs[1]), ElementsAre("coulomb_friction"));
}

TEST(Climb, ASensorThatReadsNothingBelowAThresholdIsNamed) {
  const auto lost = [](const AxisSample& s) { return -std::clamp(100.0 * s.a + 180.0 * s.v, -9.0, 9.0); };
  const Ladder ladder = ClimbWith({"sensor_dead_zone", "coulomb_friction", "output_bias"}, test::AxisData(lost));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("sensor_dead_zone"));
  EXPECT_NEAR(ladder.final_trial.fit.theta[3], 9.0, 0.5);
  EXPECT_TRUE(ladder.complete);
}

TEST(Climb, TheTrueEffectIsNamedThoughTheLawIsALittleOff) {
  const Ladder ladder = ClimbWith(kSome, test::AxisData([](const AxisSample& s) {
                                    return 15.0 * Sign(s.v) + 0.05 * (100.0 * s.a * std::sin(40.0 * s.q + 1.0) +
                                                                      180.0 * s.v * std::cos(7.0 * s.v - 20.0 * s.q));
                                  }));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("coulomb_friction"));
  EXPECT_FALSE(ladder.complete);
}

TEST(Climb, ASpringThatActsThroughPlayIsNamed) {
  // Play in front of the spring alone; mass and damper follow the position itself.
  constexpr double kHalf = 0.015;  // m
  double driven = 0.0;
  const Dataset data = test::AxisData([&](const AxisSample& s) {
    driven = std::clamp(driven, s.q - kHalf, s.q + kHalf);
    return 1500.0 * driven;
  });
  PlantDescription plant = test::AxisPlant();
  plant.law = "M*a + Fv*v + kq*q + off";
  plant.parameters.push_back({"kq", "N/m", "normal", 1000.0, 1000.0, 0.0, 20000.0});
  const Ladder ladder = ClimbWith({"backlash", "coulomb_friction", "presliding_friction", "hysteresis",
                                   "viscous_friction", "cubic_stiffness", "sensor_lag"},
                                  data, plant);
  ASSERT_EQ(ladder.rungs.size(), 2u);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("backlash"));
  EXPECT_NEAR(ladder.final_trial.fit.theta[3], 1500.0, 60.0);
}

TEST(Climb, ASpringStiffensAboutAPlaceOfItsOwn) {
  const Ladder ladder =
      ClimbWith({"cubic_stiffness", "quadratic_stiffness", "cogging", "output_drift", "baseline_tilt"},
                test::AxisData([](const AxisSample& s) { return 60000.0 * std::pow(s.q - 0.05, 3); }));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("cubic_stiffness"));
  EXPECT_TRUE(ladder.complete);
}

TEST(Climb, AnInputThatGivesWayIsFoundThoughTheLawBendsAfterIt) {
  // Stiffness and mass make up for much of what a weak input lacks: limits far from the data's are out of reach of a
  // fit that begins at these.
  const Ladder ladder =
      ClimbWith({"input_saturation", "cubic_stiffness", "coulomb_friction", "drag"},
                test::SwingData([](double u) { return 6.0 * std::tanh(u / 6.0); }), test::SwingPlant());
  ASSERT_FALSE(ladder.rungs.empty());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("input_saturation"));
}

/// A spring and a damper in series, in parallel to an axis that has a spring.
TEST(Climb, ABranchThatRelaxesIsNamedThoughItIsStretchedAtTheStart) {
  constexpr double kTau = 0.6;  // s
  for (const double stretch : {0.0, 0.05}) {
    double z = stretch;
    double last = 0.0;
    const Dataset data = test::AxisData([&](const AxisSample& s) {
      if (s.t > 0.0) z = z * std::exp(-0.01 / kTau) + (s.q - last);
      last = s.q;
      return 1500.0 * s.q + 2500.0 * z;
    });
    PlantDescription plant = test::AxisPlant();
    plant.law = "M*a + Fv*v + kq*q + off";
    plant.parameters.push_back({"kq", "N/m", "normal", 1000.0, 1000.0, 0.0, 20000.0});
    const Ladder ladder = ClimbWith(
        {"stress_relaxation", "presliding_friction", "hysteresis", "output_drift", "output_bias"}, data, plant);
    ASSERT_EQ(ladder.rungs.size(), 2u) << stretch;
    EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("stress_relaxation")) << stretch;
    EXPECT_THAT(NamesOf(ladder.rungs[1]), IsEmpty()) << stretch;
    EXPECT_TRUE(ladder.complete) << stretch;
  }
}

TEST(Climb, AWeirIsAnOverflowAndNoMode) {
  const Plant tanks = support::ReadPlant(test::SourceDir() / "core/plants/two_tanks/plant.toml");
  const auto weir = [](double level) { return 0.2 * std::pow(std::max(level - 5.0, 0.0), 1.5); };
  const Ladder ladder = ClimbWith({"overflow", "flexible_mode"}, test::TanksData(weir), tanks.description());
  ASSERT_GE(ladder.rungs.size(), 2u);
  for (const Rung& rung : ladder.rungs)
    for (const std::string& name : NamesOf(rung)) EXPECT_EQ(name, "overflow");
  EXPECT_LT(ladder.final_trial.fit.error_sd, 0.05);
}

}  // namespace
}  // namespace armcmc::ladder::climbs::climb_names_test
