// Effects that act through the start values of their states.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tools/ladder/climb_rig.hpp"
#include "tools/ladder/made_data.hpp"

namespace armcmc::ladder::climbs::start_values_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// The axis on a spring of 400 N/m.
PlantDescription SprungAxis() {
  PlantDescription plant = test::AxisPlant();
  plant.law += " + Ks*q";
  plant.parameters.push_back({"Ks", "N/m", "normal", 300.0, 300.0, 0.0, 5000.0});
  return plant;
}

/// A force that decays from the beginning of the recording, N.
double Decaying(const AxisSample& s) { return 30.0 * std::exp(-s.t / 5.0); }

TEST(Climb, AnEffectThatActsThroughItsStartAloneIsNotNamed) {
  // A stretched branch whose spring hardly responds to the motion would fit this.
  const auto hidden = [](const AxisSample& s) { return 400.0 * s.q + Decaying(s); };
  const Ladder ladder = ClimbWith({"stress_relaxation"}, test::AxisData(hidden), SprungAxis());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_THAT(ladder.notes, ::testing::Contains(::testing::HasSubstr("something decayed from the beginning")));
}

TEST(Climb, AnEffectThatAlsoRespondsToTheMotionIsNamedWithItsStart) {
  // 500 N/m behind a damper, 0.5 s, stretched at first.
  double z = 0.06;
  const auto branch = [&z](const AxisSample& s) {
    const double force = 500.0 * z;
    z += 0.01 * (s.v - z / 0.5);
    return 400.0 * s.q + force;
  };
  const Ladder ladder = ClimbWith({"stress_relaxation"}, test::AxisData(branch), SprungAxis());
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("stress_relaxation"));
}

TEST(Climb, ARecordingThatBeginsInTheMiddleOfAMotionIsNoEffect) {
  // The file says that it begins at rest; a quarter of the rows remember that it does not.
  double w = 150.0;
  const Dataset data =
      test::DataOf({.rows = 300,
                    .noise = 0.3,
                    .seed = 11,
                    .drive = [](double t) { return 3.5 * std::sin(0.9 * t) + 2.5 * std::sin(3.7 * t); },
                    .advance = [&](double u, double step) { w += step * (70.0 * u - w / 0.25); },
                    .shown = [&] { return w; }});
  const Ladder ladder = test::ClimbWith({"drag", "output_drift"}, data, test::MotorPlant());
  EXPECT_TRUE(test::NamesOf(ladder.rungs[0]).empty());
  EXPECT_TRUE(ladder.complete);
  EXPECT_LT(ladder.base.fit.error_sd, 0.35);
}

}  // namespace
}  // namespace armcmc::ladder::climbs::start_values_test
