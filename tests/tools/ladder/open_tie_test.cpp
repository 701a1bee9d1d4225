// A tie that what is named next decides.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tools/ladder/climb_rig.hpp"
#include "tools/ladder/made_data.hpp"

namespace armcmc::ladder::climbs::open_tie_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

const std::vector<std::string> kOfAxis{"coulomb_friction", "hysteresis", "presliding_friction", "baseline_tilt",
                                       "drag"};

/// A carriage without mass: dry friction that a displacement of `play` brings up, and a soft spring in parallel, N/m.
Ladder ClimbCarriage(double play, double spring) {
  PlantDescription plant = test::AxisPlant();
  plant.law = "Fv*v + off";
  plant.parameters.erase(plant.parameters.begin());
  double z = 0.0;
  const auto hidden = [&](const AxisSample& s) {
    constexpr int kSteps = 50;
    for (int i = 0; i < kSteps; ++i) z += 0.01 / kSteps * s.v / play * (1.0 - (s.v * z > 0.0 ? std::abs(z) : 0.0));
    return -100.0 * s.a + 40.0 * z + spring * s.q;
  };
  return ClimbWith(kOfAxis, test::AxisData(hidden), plant);
}

TEST(OpenTie, IsDecidedOnceTheRestIsInTheModel) {
  const Ladder ladder = ClimbCarriage(0.002, -200.0);
  ASSERT_EQ(ladder.rungs.size(), 3u);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("presliding_friction")) << "tied with hysteresis before";
  EXPECT_THAT(NamesOf(ladder.rungs[1]), ElementsAre("baseline_tilt"));
  EXPECT_THAT(NamesOf(ladder.rungs[2]), IsEmpty());
  EXPECT_TRUE(ladder.complete);
}

TEST(OpenTie, DoesNotKeepTheNextEffectFromItsName) {
  const Ladder ladder = ClimbCarriage(0.004, -200.0);
  ASSERT_EQ(ladder.rungs.size(), 2u);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), UnorderedElementsAre("hysteresis", "presliding_friction"));
  EXPECT_THAT(NamesOf(ladder.rungs[1]), ElementsAre("baseline_tilt"));
  EXPECT_EQ(ladder.plant->description().parameters.size(),
            ladder.final_trial.model->plant().description().parameters.size());
  EXPECT_TRUE(ladder.complete);
}

TEST(OpenTie, NamesNoneOfItsEffectsTwice) {
  const Ladder ladder = ClimbCarriage(0.0005, 300.0);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), UnorderedElementsAre("hysteresis", "presliding_friction"));
  for (std::size_t r = 1; r < ladder.rungs.size(); ++r)
    EXPECT_THAT(NamesOf(ladder.rungs[r]),
                ::testing::Not(::testing::Contains(::testing::AnyOf("hysteresis", "presliding_friction"))));
}

}  // namespace
}  // namespace armcmc::ladder::climbs::open_tie_test
