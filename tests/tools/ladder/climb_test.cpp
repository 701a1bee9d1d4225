#include "armcmc/ladder/climb.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "armcmc/support/effect_library.hpp"
#include "armcmc/support/plant_file.hpp"
#include "rung.hpp"
#include "support/paths.hpp"
#include "tools/ladder/climb_rig.hpp"
#include "tools/ladder/made_data.hpp"

namespace armcmc::ladder::climb_test {
namespace {

using test::AxisSample;
using test::ClimbWith;
using test::NamesOf;
using test::Sign;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::vector<std::string> kSome{"coulomb_friction", "presliding_friction", "drag",    "cubic_stiffness",
                                     "output_drift",     "asymmetric_friction", "cogging", "sensor_lag"};

TEST(Candidate, ItsParametersComeAfterThoseThatEachModeHasForItself) {
  const auto begin = [](const PlantDescription& plant) {
    return Candidate{nullptr, {}, std::make_shared<const Plant>(plant), plant.parameters.size()}.first_fitted();
  };
  EXPECT_EQ(begin(test::AxisPlant()), 3u);
  // Two valves, each with a gain and a slope.
  const auto file = test::SourceDir() / "core/plants/soft_actuator/plant.toml";
  EXPECT_EQ(begin(support::ReadPlant(file).description()), 4u);
}

TEST(Climb, NothingHiddenIsNothingMissing) {
  for (const unsigned seed : {3U, 4U, 5U}) {
    const Ladder ladder = ClimbWith(kSome, test::AxisData([](const AxisSample&) { return 0.0; }, seed));
    ASSERT_EQ(ladder.rungs.size(), 1u) << seed;
    EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty()) << seed;
    EXPECT_TRUE(ladder.complete) << seed;
    EXPECT_NEAR(ladder.noise_floor, 2.0, 0.2);
  }
}

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

TEST(Climb, AFrequencyIsNotLostToItsPrior) {
  // Fifteen times what the prior expects.
  const Ladder ladder =
      ClimbWith({"periodic_disturbance", "coulomb_friction"},
                test::AxisData([](const AxisSample& s) { return 12.0 * std::sin(148.3 * s.t + 1.0); }));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("periodic_disturbance"));
  EXPECT_TRUE(ladder.complete);
}

/// An axis that turns: angle, its rates, torque. 5 kg m^2, 9 N m s, over 5 rad.
Dataset RotaryData(const std::function<double(double angle)>& hidden) {
  constexpr double kPerMetre = 30.0;
  Dataset data = test::AxisData([&](const AxisSample& s) { return hidden(kPerMetre * s.q); });
  auto series = std::make_shared<identify::Series>(*data.series);
  for (std::size_t s = 0; s < 3; ++s)
    for (double& value : series->signals[s]) value *= kPerMetre;
  data.series = std::move(series);
  return data;
}

PlantDescription RotaryPlant() {
  PlantDescription plant = test::AxisPlant();
  const char* const units[] = {"rad", "rad/s", "rad/s^2", "N m"};
  for (std::size_t s = 0; s < plant.signals.size(); ++s) plant.signals[s].unit = units[s];
  plant.signals[3].role = "torque";
  for (ParameterDescription& p : plant.parameters) p.unit = p.unit == "kg" ? "kg m^2" : p.unit == "N" ? "N m" : "N m s";
  return plant;
}

TEST(Climb, FindsAFrequencyAlongAnAngle) {
  const Ladder ladder =
      ClimbWith({"cogging", "gravity_load"}, RotaryData([](double angle) { return 15.0 * std::sin(47.0 * angle); }),
                RotaryPlant());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("cogging"));
  ASSERT_FALSE(ladder.rungs[0].named.empty());
  EXPECT_LT(ladder.rungs[0].leader().alone.folds, 0.1);
}

TEST(Climb, WhatItsFormulaIsOffIsNoOtherEffect) {
  // Something that turns with the axis, and a little that turns twice as fast.
  const auto load = [](double angle) { return 60.0 * std::sin(angle + 0.3) + 5.0 * std::sin(2.0 * angle); };
  for (const bool kin : {false, true}) {
    const Ladder ladder =
        ClimbWith({"gravity_load", "baseline_tilt", "cubic_stiffness"}, RotaryData(load), RotaryPlant(), kin);
    ASSERT_EQ(ladder.rungs.size(), 2u);
    EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("gravity_load"));
    EXPECT_THAT(ladder.notes, ::testing::Contains(::testing::HasSubstr(kin ? "as if gravity_load had another formula"
                                                                           : "gravity_load may be as little off")));
  }
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

TEST(Climb, WhatNoEffectExplainsHasNoName) {
  const Ladder ladder = ClimbWith(
      kSome, test::AxisData([](const AxisSample& s) { return 12.0 * std::exp(-std::pow((s.q - 0.02) / 0.01, 2)); }));
  ASSERT_EQ(ladder.rungs.size(), 1u);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_EQ(ladder.rungs[0].as_if, "a curve of q were added to the output");
  EXPECT_FALSE(ladder.complete);
}

TEST(Climb, ALawThatIsALittleOffIsNoEffect) {
  const Ladder ladder = ClimbWith(
      kSome, test::AxisData([](const AxisSample& s) {
        return 0.05 * (100.0 * s.a * std::sin(40.0 * s.q + 1.0) + 180.0 * s.v * std::cos(7.0 * s.v - 20.0 * s.q));
      }));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
}

TEST(Climb, TheTrueEffectIsNamedThoughTheLawIsALittleOff) {
  const Ladder ladder = ClimbWith(kSome, test::AxisData([](const AxisSample& s) {
                                    return 15.0 * Sign(s.v) + 0.05 * (100.0 * s.a * std::sin(40.0 * s.q + 1.0) +
                                                                      180.0 * s.v * std::cos(7.0 * s.v - 20.0 * s.q));
                                  }));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("coulomb_friction"));
  EXPECT_FALSE(ladder.complete);
}

TEST(Climb, WithTheTrueEffectOutOfTheCatalogueThereIsNoFalseFamily) {
  const Ladder ladder = ClimbWith({"cubic_stiffness", "output_drift", "cogging", "stiffness_drift", "baseline_tilt"},
                                  test::AxisData([](const AxisSample& s) { return 12.0 * Sign(s.v); }));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_FALSE(ladder.complete);
}

TEST(Climb, ASpringThatStiffensIsNotMadeOfPlays) {
  const Dataset data =
      test::SwingData([](double u) { return u; }, [](double pos) { return 20.0 * pos + 40.0 * pos * pos * pos; });
  const Ladder without = ClimbWith({"backlash", "output_bias"}, data, test::SwingPlant());
  EXPECT_THAT(NamesOf(without.rungs[0]), IsEmpty());
  ASSERT_FALSE(without.notes.empty());
  EXPECT_THAT(without.notes.back(),
              ::testing::AnyOf(::testing::HasSubstr("pieces"), ::testing::HasSubstr("by a curve")));
  EXPECT_FALSE(without.complete);
  const Ladder with = ClimbWith({"backlash", "output_bias", "cubic_stiffness"}, data, test::SwingPlant());
  EXPECT_THAT(NamesOf(with.rungs[0]), ElementsAre("cubic_stiffness"));
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

TEST(Climb, AConstantThatIsOffIsNoEffect) {
  // A body that cools in a room which is half a degree warmer than the plant says, and not a thermometer that is off.
  PlantDescription plant;
  plant.name = "body";
  plant.output = "y";
  plant.law = "T";
  plant.signals = {{"P", "W", "drive", ""}, {"y", "K", "temperature", ""}};
  plant.constants = {{"room", 21.5, "K"}};
  plant.parameters = {{"C", "J/K", "lognormal", 50.0, 1.0}, {"h", "W/K", "normal", 1.0, 1.0, 0.01, 50.0}};
  plant.states = {{"T", "K", "temperature", "(P - h*(T - room))/C", "y", "", 1}};
  plant.noise.std = 0.1;
  double body = 30.0;
  const Dataset data =
      test::DataOf({.rows = 1500,
                    .noise = 0.1,
                    .seed = 6,
                    .drive = [](double t) { return 40.0 * std::max(0.0, std::sin(0.02 * t)); },
                    .advance = [&](double u, double step) { body += step * (u - 1.1 * (body - 22.0)) / 45.0; },
                    .shown = [&] { return body; },
                    .dt = 1.0});
  const Ladder ladder = ClimbWith({"output_bias", "output_drift"}, data, plant);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_THAT(ladder.rungs[0].as_if, ::testing::HasSubstr("room were 2"));
}

TEST(Climb, TheNoiseOfTheSampleThatAnIntegratorBeginsWithIsNoOffset) {
  // A cart whose place is measured: it begins at the first sample, and what this is off stays to the end.
  PlantDescription plant;
  plant.name = "cart";
  plant.output = "y";
  plant.law = "x";
  plant.signals = {{"u", "V", "drive", ""}, {"y", "m", "position", ""}};
  plant.parameters = {{"K", "m/(s^2 V)", "normal", 2.0, 1.0, 0.01, 20.0}, {"b", "1/s", "normal", 2.0, 2.0, 0.0, 50.0}};
  plant.states = {{"x", "m", "position", "v", "y", "", 1}, {"v", "m/s", "velocity", "K*u - b*v", "0", "", 1}};
  plant.noise.std = 0.02;
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    double x = 0.0, v = seed > 2 ? 1.5 : 0.0;  // it may come in at a speed, though the plant says that it rests
    const Dataset data =
        test::DataOf({.rows = 1500,
                      .noise = 0.02,
                      .seed = seed,
                      .drive = [](double t) { return 4.0 * std::sin(1.3 * t) + 3.0 * std::sin(2.9 * t); },
                      .advance =
                          [&](double u, double step) {
                            v += step * (1.5 * u - 1.2 * v);
                            x += step * v;
                          },
                      .shown = [&] { return x; }});
    const Ladder ladder = ClimbWith({"output_bias", "output_drift", "coulomb_friction", "drag"}, data, plant);
    EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty()) << seed;
    EXPECT_TRUE(ladder.complete) << seed;
    EXPECT_NEAR(ladder.base.fit.error_sd, 0.02, 0.002) << seed;
  }
}

TEST(Climb, WhatDataKeptApartDoNotShowIsWithdrawn) {
  // A drift that ends where the held-out rows begin.
  Dataset data = test::AxisData([](const AxisSample& s) { return s.t < 14.0 ? 0.9 * s.t : 0.0; });
  const Ladder ladder = ClimbWith({"output_drift"}, data);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  ASSERT_FALSE(ladder.notes.empty());
  EXPECT_THAT(ladder.notes.back(), ::testing::HasSubstr("output_drift was not named"));
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

TEST(Climb, WhatCannotBeFollowedIsLeftOut) {
  // Behind a lag the drive is a state, and a dead time in a rate cannot know what a state was before.
  const Dataset data = test::SwingData([](double u) { return u; });
  PlantDescription plant = test::SwingPlant();
  for (const EffectEntry& entry : support::ReadEffectLibrary())
    if (entry.name == "input_delay")
      plant = AddEffect(plant, entry, Bindings(plant, entry).front(), ScalesOf(data, plant, 0.003));
  const Ladder ladder = ClimbWith({"input_lag"}, data, std::move(plant));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_THAT(ladder.notes, ::testing::Contains(::testing::HasSubstr("input_lag was not tried")));
}

TEST(BetterBase, IsFoundFromWhereAnEffectHasItsParameters) {
  const Dataset data = test::MotorData([](double, double) { return 1.0; });
  const auto plant = std::make_shared<const Plant>(test::MotorPlant());
  std::vector<EffectEntry> drag;
  for (EffectEntry& entry : support::ReadEffectLibrary())
    if (entry.name == "drag") drag.push_back(std::move(entry));
  std::vector<std::string> notes;
  const std::vector<Candidate> candidates =
      Candidates(plant->description(), drag, ScalesOf(data, plant->description(), 0.3), &notes);
  ASSERT_FALSE(candidates.empty());
  Rung rung;
  rung.base.model = std::make_shared<const identify::TrajectoryModel>(plant, data.series);
  rung.base.fit = identify::Fit(*rung.base.model, data.training, Eigen::Vector2d(20.0, std::log(2.0)), 0);  // caught
  Contender contender{};
  contender.candidate = candidates.front();
  Eigen::VectorXd theta =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(contender.candidate.plant->description().parameters.size()));
  theta.head(2) << 68.0, std::log(0.26);
  contender.trial = Refine(contender.candidate.plant, data, theta);
  contender.refined = contender.trial.fit.valid;
  ASSERT_TRUE(contender.refined);
  EXPECT_FALSE(BetterBase(plant, data, rung).fit.valid);  // nobody was anywhere else
  rung.contenders.push_back(contender);
  const Trial better = BetterBase(plant, data, rung);
  ASSERT_TRUE(better.fit.valid);
  EXPECT_LT(better.fit.error_sd, 0.33);
  rung.base = better;
  EXPECT_FALSE(BetterBase(plant, data, rung).fit.valid);  // it is as good as it gets
}

TEST(Climb, NoiseOfADerivedSignalIsNoFlexibleMode) {
  // A mode that acceleration excites smooths it, and takes its noise out: of little noise all of it.
  for (const double size : {0.3, 0.1}) {
    Dataset data = test::AxisData([](const AxisSample&) { return 0.0; });
    auto series = std::make_shared<identify::Series>(*data.series);
    unsigned state = 7;
    double rough = 0.0;
    for (double& a : series->signals[2]) {
      state = state * 1664525U + 1013904223U;
      rough = 0.5 * rough + size * (static_cast<double>(state >> 8U) / 16777216.0 - 0.5);
      a += rough;
    }
    data.series = std::move(series);
    const Ladder ladder = ClimbWith({"flexible_mode", "sensor_lag"}, data);
    EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty()) << size;
    EXPECT_THAT(ladder.rungs[0].as_if, ::testing::HasSubstr("were smoother")) << size;
  }
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

TEST(Climb, FrictionIsNotOfAPressureThatStandsStill) {
  Dataset data = test::AxisData([](const AxisSample& s) { return 12.0 * Sign(s.v); });
  auto series = std::make_shared<identify::Series>(*data.series);
  std::vector<double> pressure;
  for (std::size_t n = 0; n < series->num_rows(); ++n)
    pressure.push_back(2e5 + 300.0 * std::sin(static_cast<double>(n * n % 1013)));
  series->signals.insert(series->signals.begin(), std::move(pressure));
  data.series = std::move(series);
  PlantDescription plant = test::AxisPlant();
  plant.signals.insert(plant.signals.begin(), {"p", "Pa", "pressure", ""});
  const Ladder ladder = ClimbWith({"coulomb_friction", "pressure_dependent_friction"}, data, plant);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("coulomb_friction"));
}

TEST(Climb, NoiseThatNeighbouringSamplesShareIsNoise) {
  double shared = 0.0;
  unsigned state = 7;
  Dataset data = test::AxisData([&](const AxisSample&) {
    state = state * 1664525U + 1013904223U;
    shared = 0.8 * shared + 6.0 * (static_cast<double>(state >> 8U) / 16777216.0 - 0.5);
    return shared;
  });
  const Ladder ladder = ClimbWith(kSome, data);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_GT(ladder.base.fit.error_sd, 1.3 * ladder.noise_floor);
  EXPECT_TRUE(ladder.complete);
}

TEST(Climb, AnOffsetThatComesAndGoesIsNotNoise) {
  const Ladder ladder = ClimbWith(kSome, test::AxisData([](const AxisSample& s) {
                                    return std::sin(2.3 * s.t + 3.0 * std::sin(0.7 * s.t)) > 0.0 ? 10.0 : 0.0;
                                  }));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_FALSE(ladder.complete);
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

TEST(Climb, WhatASpringIsOffFromItsFormulaIsNoCogging) {
  // Less than three periods over the whole range bend as anything else does.
  const auto spring = [](double pos) { return 20.0 * pos * std::exp(pos * pos / 0.1); };
  const Ladder ladder = ClimbWith({"cubic_stiffness", "cogging"}, test::SwingData([](double u) { return u; }, spring),
                                  test::SwingPlant());
  for (const Rung& rung : ladder.rungs)
    for (const std::string& name : NamesOf(rung)) EXPECT_EQ(name, "cubic_stiffness");
}

}  // namespace
}  // namespace armcmc::ladder::climb_test
