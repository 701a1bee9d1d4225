// Names that are tested again beside those that followed them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tools/ladder/climb_rig.hpp"
#include "tools/ladder/made_data.hpp"

namespace armcmc::ladder::climbs::reselect_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A triangle with rounded corners, 2.5 s long, over 0.1 m.
AxisSample Triangle(double t) {
  constexpr double kRate = 2.5, kSize = 0.05 * 8.0 / (M_PI * M_PI);
  AxisSample s{t, 0.0, 0.0, 0.0};
  for (int k = 0; k < 12; ++k) {
    const double n = 2.0 * k + 1.0, size = (k % 2 == 0 ? kSize : -kSize) / (n * n) * std::exp(-n * n / 250.0);
    s.q += size * std::sin(n * (kRate * t + 0.3));
    s.v += size * n * kRate * std::cos(n * (kRate * t + 0.3));
    s.a -= size * n * n * kRate * kRate * std::sin(n * (kRate * t + 0.3));
  }
  return s;
}

/// An axis whose mass is known, and whose viscous friction is known to 3 %.
PlantDescription KnownAxis() {
  PlantDescription plant = test::AxisPlant();
  plant.parameters.erase(plant.parameters.begin(), plant.parameters.begin() + 2);
  plant.constants = {{"M", 100.0, "kg"}, {"Fv", 175.0, "N s/m"}};
  return plant;
}

const std::vector<std::string> kAlike{"backlash", "coulomb_friction", "presliding_friction", "hysteresis",
                                      "baseline_tilt"};

TEST(Reselect, WhatActsLikeASpringWithFrictionGivesWayToBoth) {
  const auto hidden = [](const AxisSample& s) { return 15.0 * std::tanh(s.v / 0.005) + 350.0 * s.q; };
  const Ladder ladder = ClimbWith(kAlike, test::AxisData(hidden, 3, Triangle), KnownAxis());
  ASSERT_EQ(ladder.rungs.size(), 3u);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), ElementsAre("coulomb_friction"));
  EXPECT_THAT(NamesOf(ladder.rungs[1]), ElementsAre("baseline_tilt"));
  EXPECT_THAT(NamesOf(ladder.rungs[2]), IsEmpty());
  EXPECT_TRUE(ladder.complete);
  EXPECT_THAT(ladder.notes, ::testing::Contains(HasSubstr("hysteresis, named at first, is not needed: beside "
                                                          "coulomb_friction, baseline_tilt explains the data")));
  // The rungs are those of the ladder as it stands: each begins where the one before it ends.
  EXPECT_EQ(ladder.rungs[1].base.fit.theta, ladder.rungs[0].leader().trial.fit.theta);
  EXPECT_EQ(ladder.final_trial.fit.theta, ladder.rungs[1].leader().trial.fit.theta);
  EXPECT_LT(ladder.rungs[0].leader().trial.fit.error_sd, ladder.rungs[0].base.fit.error_sd);
  EXPECT_GT(ladder.rungs[0].probability, 0.9);
  EXPECT_GT(ladder.rungs[1].probability, 0.9);
  const Eigen::VectorXd& theta = ladder.final_trial.fit.theta;
  const auto value = [&](const Rung& rung) {
    return theta[static_cast<Eigen::Index>(rung.leader().candidate.first_fitted())];
  };
  EXPECT_NEAR(value(ladder.rungs[0]), 15.0, 1.0);
  EXPECT_NEAR(value(ladder.rungs[1]), 350.0, 35.0);
}

std::vector<std::string> AllNames(const Ladder& ladder) {
  std::vector<std::string> names;
  for (const Rung& rung : ladder.rungs)
    for (const std::string& name : NamesOf(rung)) names.push_back(name);
  return names;
}

TEST(Reselect, AFormulaThatIsNotNeededBesideALaterOneIsDropped) {
  const auto hidden = [](const AxisSample& s) { return 40.0 * std::tanh(s.v / 0.003) + 600.0 * s.q; };
  const Ladder ladder = ClimbWith({"coulomb_friction", "baseline_tilt", "cubic_stiffness"}, test::AxisData(hidden));
  EXPECT_THAT(AllNames(ladder), ::testing::UnorderedElementsAre("coulomb_friction", "baseline_tilt"));
  EXPECT_TRUE(ladder.complete);
  EXPECT_THAT(ladder.notes, ::testing::Contains(HasSubstr("coulomb_friction is named once")));
}

TEST(Reselect, APlayThatIsThereKeepsItsName) {
  constexpr double kPlay = 0.012, kTakenUp = 0.003;  // m, half the width each
  double driven = 0.0;
  const auto hidden = [&](const AxisSample& s) {
    const double most = kPlay + kTakenUp, ahead = std::clamp(s.q - driven, -most, most);
    driven = std::clamp(driven, s.q - most, s.q + most);
    const double taken_up = std::max(std::abs(ahead) - kPlay, 0.0) / kTakenUp;
    return 30.0 * Sign(ahead) * std::pow(taken_up, 1.5) + 2e5 * s.q * s.q * s.q;
  };
  const Ladder ladder =
      ClimbWith({"backlash", "coulomb_friction", "presliding_friction", "cubic_stiffness"}, test::AxisData(hidden));
  EXPECT_THAT(AllNames(ladder), ::testing::IsSupersetOf({"backlash", "cubic_stiffness"}));
}

}  // namespace
}  // namespace armcmc::ladder::climbs::reselect_test
