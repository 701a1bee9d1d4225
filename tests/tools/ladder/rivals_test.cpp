// What else may explain what an effect seems to: curves, constants of the plant, and the effects that were named
// before.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "armcmc/ladder/features.hpp"
#include "motion_rival.hpp"
#include "tools/ladder/climb_rig.hpp"
#include "tools/ladder/made_data.hpp"

namespace armcmc::ladder::climbs::rivals_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::vector<std::string> kOfMotor{"drag", "coulomb_friction", "input_saturation", "sensor_saturation"};

TEST(Climb, WhatActsLikeANameAndIsSmallBesideItIsAnErrorOfItsFormula) {
  // Rounder than the catalogue's hysteresis, which a play would compensate.
  double z = 0.0;
  const auto rounder = [&z](const AxisSample& s) {
    constexpr int kSteps = 20;
    for (int i = 0; i < kSteps; ++i)
      z += 0.01 / kSteps * s.v / 0.02 * (1.0 - std::pow(std::abs(z), 1.6) * (0.5 + 0.5 * Sign(s.v * z)));
    return 60.0 * z;
  };
  const Ladder ladder = ClimbWith({"hysteresis", "backlash"}, test::AxisData(rounder));
  ASSERT_EQ(ladder.rungs.size(), 2u);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("hysteresis"));
  EXPECT_THAT(NamesOf(ladder.rungs[1]), IsEmpty());
}

TEST(Climb, ASensorWithACurveOfItsOwnIsNoSpring) {
  const auto hidden = [](const AxisSample& s) {
    const double force = 100.0 * s.a + 180.0 * s.v;
    return -0.003 * force * std::abs(force);
  };
  const Ladder ladder = ClimbWith({"cubic_stiffness", "inertia", "drag"}, test::AxisData(hidden));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_EQ(ladder.rungs[0].as_if, "a curve of the output were measured");
}

TEST(Climb, WhatACurveOfAnotherShapeExplainsFarBetterIsNotNamed) {
  // A field that weakens with speed, which no catalogue has: drag takes most of it.
  const Ladder ladder =
      ClimbWith(kOfMotor, test::MotorData([](double w, double) { return 1.0 / (1.0 + std::pow(w / 90.0, 2)); }),
                test::MotorPlant());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_GT(1.0 - ladder.rungs[0].contenders[0].alone.folds, 0.5);
  EXPECT_EQ(ladder.rungs[0].as_if, "K followed speed by a curve");
  EXPECT_THAT(ladder.notes, ::testing::Contains(::testing::HasSubstr("as if K followed speed by a curve")));
  EXPECT_FALSE(ladder.complete);
}

TEST(Climb, AFormulaThatIsOffIsNamedWhereTheCurveThatDoesBetterHoldsIt) {
  // A limit that is soft: any curve of the voltage does better than the sharp one.
  const Ladder ladder =
      ClimbWith(kOfMotor, test::MotorData([](double, double u) { return std::tanh(u / 5.0) / (u / 5.0 + 1e-12); }),
                test::MotorPlant());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("input_saturation"));
  EXPECT_FALSE(ladder.complete);
}

TEST(Climb, ASpringThatStiffensFasterThanItsFormulaIsNamed) {
  const auto spring = [](double pos) { return 1.2 * std::sinh(pos / 0.06); };
  const Ladder ladder = ClimbWith({"cubic_stiffness", "backlash"}, test::SwingData([](double u) { return u; }, spring),
                                  test::SwingPlant());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("cubic_stiffness"));
}

/// A motor that is switched up and down, and loses more and more of its speed the faster it is.
Dataset LossyData() {
  double w = 0.0;
  return test::DataOf(
      {.rows = 1000,
       .noise = 0.3,
       .seed = 11,
       .drive = [](double t) { return 2.0 + (std::sin(0.7 * t) > 0.3 ? 3.0 : 0.0) + std::sin(3.1 * t); },
       .advance = [&](double u, double step) { w += step * (70.0 * u - w / 0.5 - 3e-4 * w * w * w); },
       .shown = [&] { return w; }});
}

TEST(Climb, WhatFollowsAnotherQuantityIsNotProtectedByACurveThatCanCopyIt) {
  for (const std::string other : {"input_hysteresis", "output_drift"}) {
    const Ladder ladder = ClimbWith({other}, LossyData(), test::MotorPlant());
    EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty()) << other;
  }
}

/// A warm body that loses 0.5 W/K, and by radiation what a black surface of 0.1 m^2 would; its room has 22 degrees.
/// 40 minutes, a noise of 0.1 K.
Dataset RadiatorData() {
  const auto shone = [](double degrees) { return 0.1 * 5.67e-8 * std::pow(degrees + 273.15, 4); };
  double warmth = 50.0;
  return test::DataOf(
      {.rows = 1200,
       .noise = 0.1,
       .seed = 5,
       .drive = [](double t) { return 60.0 + 25.0 * std::sin(0.011 * t) + 15.0 * std::sin(0.037 * t + 1.0); },
       .advance =
           [&](double u, double step) {
             warmth += step * (u - 0.5 * (warmth - 22.0) - shone(warmth) + shone(22.0)) / 90.0;
           },
       .shown = [&] { return warmth; },
       .dt = 2.0});
}

PlantDescription RadiatorPlant() {
  PlantDescription plant;
  plant.name = "radiator";
  plant.output = "y";
  plant.law = "T";
  plant.signals = {{"P", "W", "drive", ""}, {"y", "degC", "temperature", ""}};
  plant.constants = {{"Ta", 22.0, "degC"}};
  plant.parameters = {{"C", "J/K", "lognormal", 80.0, 0.7}, {"h", "W/K", "normal", 1.0, 1.0, 0.01, 20.0}};
  plant.states = {{"T", "degC", "temperature", "(P - h*(T - Ta))/C", "50", "", 1}};
  plant.noise.std = 0.1;
  return plant;
}

TEST(Climb, WhatALawExplainsThatIsBentIsNoOffset) {
  const Ladder ladder = ClimbWith({"output_bias", "input_bias", "output_drift"}, RadiatorData(), RadiatorPlant());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_GT(1.0 - ladder.rungs[0].contenders[0].alone.folds, 0.5);
  EXPECT_THAT(ladder.notes,
              ::testing::Contains(::testing::HasSubstr("output_bias was not named: it acts as if h varied "
                                                       "with T")));
}

TEST(Climb, RadiationIsNamedBeforeAnOffset) {
  const Ladder ladder = ClimbWith({"output_bias", "input_bias", "output_drift", "linear_loss", "radiation"},
                                  RadiatorData(), RadiatorPlant());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("radiation"));
  EXPECT_TRUE(ladder.complete);
}

/// To and fro at one frequency, over a range that grows.
AxisSample ToAndFro(double t) {
  constexpr double kW = 1.4, kGrows = 0.002;  // rad/s, m/s
  const double range = kGrows * (20.0 + t), sine = std::sin(kW * t), cosine = std::cos(kW * t);
  return {t, range * sine, kGrows * sine + range * kW * cosine, 2.0 * kGrows * kW * cosine - range * kW * kW * sine};
}

/// A carriage without mass that is so moved, with hidden friction, a spring, and a hum.
Ladder ClimbRubbing(const std::vector<std::string>& effects, double hum) {
  PlantDescription plant = test::AxisPlant();
  plant.law = "Fv*v + off";
  plant.parameters.erase(plant.parameters.begin());
  const auto hidden = [hum](const AxisSample& s) {
    return -100.0 * s.a + 10.0 * Sign(s.v) + 400.0 * s.q + hum * std::sin(7.0 * s.t);
  };
  return ClimbWith(effects, test::AxisData(hidden, 3, ToAndFro), plant);
}

TEST(Climb, WhatRepeatsWithTheMotionIsNoDisturbance) {
  const Ladder ladder = ClimbRubbing({"periodic_disturbance"}, 0.0);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_LT(ladder.rungs[0].contenders[0].alone.folds, 0.2) << "it explains nearly all of it";
  EXPECT_EQ(ladder.rungs[0].as_if, "the motion were its cause");
}

TEST(MotionRival, IsNoneOfAHumNorOfAnotherEffect) {
  const Ladder ladder = ClimbRubbing({"periodic_disturbance", "coulomb_friction"}, 60.0);
  const Rung& rung = ladder.rungs[0];
  for (const Contender& c : rung.contenders)
    EXPECT_FALSE(c.trial.judged && MotionRivalOf(rung.view, rung.base, c)) << c.candidate.entry->name;
}

TEST(Climb, AHumBesideTheMotionIsADisturbance) {
  const Ladder ladder = ClimbRubbing({"periodic_disturbance", "coulomb_friction", "baseline_tilt"}, 60.0);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("periodic_disturbance"));
  EXPECT_NEAR(std::exp(ladder.rungs[0].leader().trial.fit.theta[4]), 7.0, 0.01);
}

/// The axis against a stop that its file puts at zero.
PlantDescription StoppedAxis() {
  PlantDescription plant = test::AxisPlant();
  const std::string free = plant.law;
  plant.modes = {{"stop", "q >= 0", free + " + k*q^p", "", false}, {"free", "", free, "", false}};
  plant.law.clear();
  plant.parameters.push_back({"k", "N/m^p", "normal", 5000.0, 5000.0, 0.0, 1e5});
  plant.parameters.push_back({"p", "1", "normal", 1.5, 0.3, 1.0, 2.5});
  return plant;
}

/// @param stop  Where it is, m.
Dataset StoppedData(double stop, double cubic) {
  return test::AxisData(
      [=](const AxisSample& s) { return 2500.0 * std::pow(std::max(s.q - stop, 0.0), 1.5) + cubic * s.q * s.q * s.q; });
}

TEST(Climb, ALawThatBeginsElsewhereIsNoSpring) {
  const Ladder ladder = ClimbWith({"cubic_stiffness", "quadratic_stiffness"}, StoppedData(-0.04, 0.0), StoppedAxis());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_THAT(ladder.notes, ::testing::Contains(::testing::HasSubstr("as if the modes changed at another q")));
}

TEST(Climb, ALawThatBeginsElsewhereIsNamedWhereTheCatalogueHasIt) {
  const Ladder ladder =
      ClimbWith({"cubic_stiffness", "quadratic_stiffness", "contact_offset"}, StoppedData(-0.04, 0.0), StoppedAxis());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("contact_offset"));
}

TEST(Climb, ASpringBesideALawThatBeginsWhereItSaysIsNamed) {
  const Ladder ladder = ClimbWith({"cubic_stiffness"}, StoppedData(0.0, 3e4), StoppedAxis());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("cubic_stiffness"));
}

/// A spring under tension that weakens or stiffens by a fifth of its force, weak enough for the noise to hide that the
/// force does not drift everywhere by the same.
Dataset WeakeningData() {
  return test::AxisData([](const AxisSample& s) { return 150.0 * (1.0 + 0.01 * s.t) * (s.q + 0.2); });
}

PlantDescription TensedAxis() {
  PlantDescription plant = test::AxisPlant();
  plant.law += " + k*(q + 0.2)";
  plant.parameters.push_back({"k", "N/m", "normal", 150.0, 100.0, 0.0, 1e4});
  return plant;
}

TEST(Climb, WhatAParameterExplainsThatFollowsTimeIsNoDriftOfTheForce) {
  const Ladder ladder = ClimbWith({"output_drift"}, WeakeningData(), TensedAxis());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_THAT(ladder.notes, ::testing::Contains(::testing::HasSubstr("as if k drifted")));
}

TEST(Climb, AZeroThatIsElsewhereIsNoSpring) {
  // Far from the place about which it stiffens, a spring is an offset.
  const Ladder ladder = ClimbWith({"cubic_stiffness"}, test::AxisData([](const AxisSample&) { return 100.0; }));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_THAT(ladder.notes, ::testing::Contains(::testing::HasSubstr("as if the output had another zero")));
}

TEST(Climb, AZeroThatDriftsIsNoPlay) {
  const Dataset data = test::AxisData([](const AxisSample& s) { return 150.0 * (s.q + 0.2) + 1.5 * s.t; });
  const Ladder ladder = ClimbWith(
      {"backlash", "hysteresis", "presliding_friction", "stiffness_drift", "stress_relaxation"}, data, TensedAxis());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_THAT(ladder.notes, ::testing::Contains(::testing::HasSubstr("as if the zero of the output drifted")));
}

TEST(Climb, ConstantsThatAreEachALittleOffTogetherRuleOutAnEffect) {
  // Springs for either side, both 4 % stiffer than the file says: neither alone explains what a tilt does.
  PlantDescription plant = test::AxisPlant();
  plant.law += " + k1*max(q, 0) + k2*min(q, 0)";
  plant.constants = {{"k1", 2000.0, "N/m"}, {"k2", 2000.0, "N/m"}};
  const Ladder ladder =
      ClimbWith({"baseline_tilt"}, test::AxisData([](const AxisSample& s) { return 2080.0 * s.q; }), plant);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_THAT(ladder.rungs[0].as_if, ::testing::HasSubstr(" and k2 were "));
}

/// The axis on a spring that its file makes 2.5 % too soft.
PlantDescription SprungAxis() {
  PlantDescription plant = test::AxisPlant();
  plant.law += " + k*q";
  plant.constants = {{"k", 40000.0, "N/m"}};
  return plant;
}

TEST(Climb, AnEffectThatIsHiddenBehindAConstantThatIsOffIsNamed) {
  const auto hidden = [](const AxisSample& s) { return 41000.0 * s.q + 6.0 * Sign(s.v); };
  const Ladder ladder = ClimbWith({"coulomb_friction", "drag"}, test::AxisData(hidden), SprungAxis());
  ASSERT_FALSE(ladder.rungs.empty());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("coulomb_friction"));
  ASSERT_TRUE(ladder.free_constants);
  EXPECT_THAT(AsIf(*ladder.free_constants, ladder.final_trial, ladder.view.data.training),
              ::testing::StartsWith("k were 4.1e+04 instead of 4e+04"));
  EXPECT_TRUE(ladder.complete);
  // The model before is the one in the file.
  EXPECT_GT(ladder.base.fit.error_sd, 20.0);
}

TEST(Climb, WithNothingButAConstantOffNothingIsNamedAndTheConstantIsTold) {
  const Ladder ladder = ClimbWith({"coulomb_friction", "drag"},
                                  test::AxisData([](const AxisSample& s) { return 41000.0 * s.q; }), SprungAxis());
  ASSERT_EQ(ladder.rungs.size(), 1u);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_THAT(ladder.rungs[0].as_if, ::testing::StartsWith("k were 4.1e+04 instead of 4e+04"));
  EXPECT_FALSE(ladder.free_constants);
  EXPECT_FALSE(ladder.complete);
}

TEST(FeaturesOf, LeavesOutTheSignalThatALawExplains) {
  PlantDescription plant = test::AxisPlant();
  plant.modes = {{"always", "", plant.law, "F", false}};
  plant.law.clear();
  plant.output = "q";
  const identify::TrajectoryModel model(std::make_shared<const Plant>(plant),
                                        test::AxisData([](const AxisSample&) { return 0.0; }).series);
  std::vector<std::string> names;
  for (const Feature& feature : FeaturesOf(model, model.Start())) names.push_back(feature.name);
  EXPECT_THAT(names, ElementsAre("v", "a"));
}

TEST(Climb, ASensorWithoutASignIsFoundThoughTheLawAloneFitsNowhere) {
  double w = 0.0;
  const Dataset data =
      test::DataOf({.rows = 1000,
                    .noise = 0.3,
                    .seed = 11,
                    .drive = [](double t) { return 3.0 * std::sin(0.9 * t) + 1.5 * std::sin(2.3 * t + 1.0); },
                    .advance = [&](double u, double step) { w += step * (70.0 * u - w / 0.25); },
                    .shown = [&] { return std::abs(w); }});
  const Ladder ladder =
      ClimbWith({"absolute_value_sensor", "input_saturation", "output_bias"}, data, test::MotorPlant());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("absolute_value_sensor"));
  EXPECT_TRUE(ladder.complete);
}

TEST(Climb, WhatDataKeptApartShowLittleOfIsNotWithdrawn) {
  // Drag, and a drive that is so weak in the rows kept apart that noise is most of the error there.
  double w = 0.0;
  const Dataset data = test::DataOf(
      {.rows = 1000,
       .noise = 0.3,
       .seed = 11,
       .drive =
           [](double t) { return (t < 14.0 ? 1.0 : 0.35) * (3.5 * std::sin(0.9 * t) + 2.5 * std::sin(3.7 * t + 1.0)); },
       .advance = [&](double u, double step) { w += step * (70.0 * u - w / 0.25 - 0.01 * w * std::abs(w)); },
       .shown = [&] { return w; }});
  const Ladder ladder = ClimbWith({"drag"}, data, test::MotorPlant());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("drag"));
}

}  // namespace
}  // namespace armcmc::ladder::climbs::rivals_test
