// The rules of the ladder that a second shows: under the sanitizers as well.
#include "armcmc/ladder/climb.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/support/effect_library.hpp"
#include "armcmc/support/plant_file.hpp"
#include "rung.hpp"
#include "support/paths.hpp"
#include "tools/ladder/climb_rig.hpp"
#include "tools/ladder/made_data.hpp"

namespace armcmc::ladder::climbs::climb_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Candidate, ItsParametersComeAfterThoseThatEachModeHasForItself) {
  const auto begin = [](const PlantDescription& plant) {
    return Candidate{nullptr, {}, std::make_shared<const Plant>(plant), plant.parameters.size()}.first_fitted();
  };
  EXPECT_EQ(begin(test::AxisPlant()), 3u);
  // Two valves, each with a gain and a slope.
  const auto file = test::SourceDir() / "core/plants/soft_actuator/plant.toml";
  EXPECT_EQ(begin(support::ReadPlant(file).description()), 4u);
}

TEST(Climb, AFrequencyIsNotLostToItsPrior) {
  // Fifteen times what the prior expects.
  const Ladder ladder =
      ClimbWith({"periodic_disturbance", "coulomb_friction"},
                test::AxisData([](const AxisSample& s) { return 12.0 * std::sin(148.3 * s.t + 1.0); }));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("periodic_disturbance"));
  EXPECT_TRUE(ladder.complete);
}

TEST(Climb, FindsAFrequencyAlongAnAngle) {
  const Ladder ladder =
      ClimbWith({"cogging", "gravity_load"}, RotaryData([](double angle) { return 15.0 * std::sin(47.0 * angle); }),
                RotaryPlant());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("cogging"));
  ASSERT_FALSE(ladder.rungs[0].named.empty());
  EXPECT_LT(ladder.rungs[0].leader().alone.folds, 0.1);
}

TEST(Climb, WhatNoEffectExplainsHasNoName) {
  const Ladder ladder = ClimbWith(
      kSome, test::AxisData([](const AxisSample& s) { return 12.0 * std::exp(-std::pow((s.q - 0.02) / 0.01, 2)); }));
  ASSERT_EQ(ladder.rungs.size(), 1u);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_EQ(ladder.rungs[0].as_if, "a curve of q were added to the output");
  EXPECT_FALSE(ladder.complete);
}

TEST(Climb, WithTheTrueEffectOutOfTheCatalogueThereIsNoFalseFamily) {
  const Ladder ladder = ClimbWith({"cubic_stiffness", "output_drift", "cogging", "stiffness_drift", "baseline_tilt"},
                                  test::AxisData([](const AxisSample& s) { return 12.0 * Sign(s.v); }));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_FALSE(ladder.complete);
}

TEST(Climb, WhatDataKeptApartDoNotShowIsWithdrawn) {
  // A drift that ends where the held-out rows begin.
  Dataset data = test::AxisData([](const AxisSample& s) { return s.t < 14.0 ? 0.9 * s.t : 0.0; });
  const Ladder ladder = ClimbWith({"output_drift"}, data);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  ASSERT_FALSE(ladder.notes.empty());
  EXPECT_THAT(ladder.notes.back(), ::testing::HasSubstr("output_drift was not named"));
}

TEST(Climb, AFormulaThatMakesAnEarlierOneNeedlessReplacesIt) {
  const Dataset data = test::AxisData([](const AxisSample& s) { return 60.0 * std::tanh(s.v / 0.005); });
  const Ladder ladder = ClimbWith({"coulomb_friction"}, data);
  ASSERT_EQ(ladder.rungs.size(), 2U);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("coulomb_friction"));
  EXPECT_EQ(ladder.rungs[0].leader().candidate.form().name, "smooth");
  EXPECT_TRUE(ladder.complete);
  EXPECT_THAT(NamesOf(ladder.rungs[1]), IsEmpty());
}

TEST(Climb, AFormulaThatAnotherOneOfItsEffectDoesNotMakeNeedlessStays) {
  const Ladder ladder =
      ClimbWith({"coulomb_friction"},
                test::AxisData([](const AxisSample& s) { return 15.0 * Sign(s.v) + 40.0 * std::tanh(s.v / 0.05); }));
  ASSERT_GE(ladder.rungs.size(), 2U);
  for (const std::size_t r : {0U, 1U}) EXPECT_THAT(NamesOf(ladder.rungs[r]), ElementsAre("coulomb_friction")) << r;
  EXPECT_NE(ladder.rungs[0].leader().candidate.form().name, ladder.rungs[1].leader().candidate.form().name);
  EXPECT_TRUE(ladder.complete);
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

}  // namespace
}  // namespace armcmc::ladder::climbs::climb_test
