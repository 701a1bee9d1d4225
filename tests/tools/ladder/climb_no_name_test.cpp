// Misfits that look like an effect and are given no name.
#include "armcmc/ladder/climb.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/support/effect_library.hpp"
#include "tools/ladder/climb_rig.hpp"
#include "tools/ladder/made_data.hpp"

namespace armcmc::ladder::climbs::climb_no_name_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Climb, NothingHiddenIsNothingMissing) {
  for (const unsigned seed : {3U, 4U, 5U}) {
    const Ladder ladder = ClimbWith(kSome, test::AxisData([](const AxisSample&) { return 0.0; }, seed));
    ASSERT_EQ(ladder.rungs.size(), 1u) << seed;
    EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty()) << seed;
    EXPECT_TRUE(ladder.complete) << seed;
    EXPECT_NEAR(ladder.noise_floor, 2.0, 0.2);
  }
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

TEST(Climb, ALawThatIsALittleOffIsNoEffect) {
  const Ladder ladder = ClimbWith(
      kSome, test::AxisData([](const AxisSample& s) {
        return 0.05 * (100.0 * s.a * std::sin(40.0 * s.q + 1.0) + 180.0 * s.v * std::cos(7.0 * s.v - 20.0 * s.q));
      }));
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
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

/// A cell u, y that gives way at once and, behind a slow pair of its own, later on; it knows nothing of a faster pair.
Dataset CellData(double faster) {
  double slow = 0.0, fast = 0.0, current = 0.0;
  return test::DataOf({.rows = 1200,
                       .noise = 0.002,
                       .seed = 9,
                       .drive =
                           [](double t) {
                             const double chaos = 43758.5 * std::sin(12.9898 * std::floor(t / 40.0));
                             return 4.0 * (chaos - std::floor(chaos)) - 1.5 + std::sin(0.05 * t);
                           },
                       .advance =
                           [&](double u, double step) {
                             current = u;
                             slow += step * (0.04 * u - slow) / 70.0;
                             fast += step * (faster * u - fast) / 9.0;
                           },
                       .shown = [&] { return -slow - fast - 0.03 * current; },
                       .dt = 1.0});
}

PlantDescription Cell() {
  PlantDescription plant;
  plant.name = "cell";
  plant.output = "y";
  plant.law = "-pair - R0*u";
  plant.signals = {{"u", "A", "drive", ""}, {"y", "V", "voltage", ""}};
  plant.parameters = {{"R0", "Ohm", "normal", 0.03, 0.03, 0.0, 1.0},
                      {"R1", "Ohm", "normal", 0.03, 0.03, 0.0, 1.0},
                      {"tau", "s", "lognormal", 60.0, 0.7}};
  plant.states = {{"pair", "V", "voltage", "(R1*u - pair)/tau", "0", "", 1}};
  plant.noise.std = 0.002;
  return plant;
}

TEST(Climb, ADiffusionThatDoesNotOscillateIsNoFlexibleMode) {
  EXPECT_THAT(NamesOf(ClimbWith({"flexible_mode"}, CellData(0.02), Cell()).rungs[0]), IsEmpty());
  EXPECT_THAT(NamesOf(ClimbWith({"flexible_mode", "slow_response"}, CellData(0.02), Cell()).rungs[0]),
              ElementsAre("slow_response"));
}

TEST(Climb, NoiseThatNeighboursShareIsNothingMissingThoughTheMotionIsSlow) {
  // A motion of which the recording shows two and a half periods.
  double w = 0.0, shared = 0.0;
  std::mt19937_64 random(21);
  std::normal_distribution<double> fresh(0.0, 1.0);
  const Dataset data = test::DataOf({.rows = 1000,
                                     .noise = 0.1,
                                     .seed = 11,
                                     .drive = [](double t) { return 4.0 * std::sin(0.75 * t); },
                                     .advance = [&](double u, double step) { w += step * (70.0 * u - w / 0.25); },
                                     .shown =
                                         [&] {
                                           shared = 0.6 * shared + 0.8 * fresh(random);
                                           return w + 0.6 * shared;
                                         }});
  const Ladder ladder = ClimbWith({"sensor_lag", "drag"}, data, test::MotorPlant());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_GT(ladder.base.fit.error_sd, 1.2 * ladder.noise_floor);
  EXPECT_TRUE(ladder.complete);
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
}  // namespace armcmc::ladder::climbs::climb_no_name_test
