// Which of the effects that were tried on a rung are named: the rules of ties, on figures that are set by hand, and
// models that do not predict the output at all.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "rung.hpp"
#include "shares.hpp"
#include "tools/ladder/climb_rig.hpp"
#include "tools/ladder/made_data.hpp"

namespace armcmc::ladder::climbs::naming_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;

/// A rung on which two effects, which are kin of different families, are compared; neither formula is exact.
struct Compared {
  Ladder ladder;
  Rung rung;
  Contender *hysteresis = nullptr, *presliding = nullptr;

  Compared() {
    double z = 0.0;  // rounder than either formula
    const auto rounder = [&z](const AxisSample& s) {
      constexpr int kSteps = 20;
      for (int i = 0; i < kSteps; ++i)
        z += 0.01 / kSteps * s.v / 0.02 * (1.0 - std::pow(std::abs(z), 1.6) * (0.5 + 0.5 * Sign(s.v * z)));
      return 60.0 * z;
    };
    ladder = test::ClimbWith({"hysteresis", "presliding_friction"}, test::AxisData(rounder));
    rung = ladder.rungs[0];
    for (Contender& c : rung.contenders) {
      c.has_evidence = c.larger_part = false;
      c.ruled_out = false;
      Contender*& best = c.candidate.entry->name == "hysteresis" ? hysteresis : presliding;
      if (best == nullptr) best = &c;
    }
    for (Contender* c : {hysteresis, presliding}) {
      c->has_evidence = c->larger_part = true;
      c->gain_share = 1.0;
      c->win_share = 0.0;
    }
    hysteresis->alone = {0.1, 0.2, 0.2};
    presliding->alone = {0.4, 0.3, 0.3};
  }

  /// @param floor  N; by default far below the errors, so that no formula is exact.
  std::vector<std::string> Named(double floor = 0.5) {
    Name(rung.view, floor, false, &rung);
    return NamesOf(rung);
  }
};

/// How drag was tried where it explains a sixth of what the base leaves.
struct TriedDrag {
  bool refined, judged;
};
TriedDrag TryDrag(const std::set<std::string>* above_tie) {
  constexpr double kDrag = 800.0;  // N s^2/m^2
  const Dataset data =
      test::AxisData([](const AxisSample& s) { return kDrag * std::abs(s.v) * s.v + 20.0 * std::sin(20.0 * s.t); });
  const Ladder ladder = ClimbWith({"drag"}, data);
  Rung rung = ladder.rungs[0];
  for (Contender& c : rung.contenders) {
    c.trial = {};
    c.refined = false;
  }
  std::vector<std::string> notes;
  const std::shared_ptr<const Plant> plant = std::make_shared<const Plant>(rung.base.model->plant().description());
  TryAll(plant, rung.view.data, rung.view, ladder.noise_floor, above_tie, &rung, &notes);
  const auto any = [&](auto which) { return std::any_of(rung.contenders.begin(), rung.contenders.end(), which); };
  return {any([](const Contender& c) { return c.refined; }), any([](const Contender& c) { return c.trial.judged; })};
}

TEST(RuleOut, WhatIsTheSameWithMoreParametersIsRuledOutToo) {
  // Dry friction without a peak: the law of Stribeck is that of Coulomb.
  const Ladder ladder = ClimbWith({"coulomb_friction", "stribeck_friction", "drag"},
                                  test::AxisData([](const AxisSample& s) { return 40.0 * Sign(s.v); }));
  Rung rung = ladder.rungs[0];
  ASSERT_THAT(NamesOf(rung), ElementsAre("coulomb_friction"));
  RuleOut(rung.view, rung.named.front(), &rung);
  while (true) {
    Name(rung.view, ladder.noise_floor, false, &rung);
    if (rung.named.empty()) break;
    ASSERT_EQ(rung.leader().candidate.entry->name, "coulomb_friction") << "another form of it";
    RuleOut(rung.view, rung.named.front(), &rung);
  }
  EXPECT_THAT(NamesOf(rung), IsEmpty());
}

TEST(TryAll, AboveATieWhatRemovesASmallPartIsNotRefittedUnlessItsFamilyWasNamed) {
  const TriedDrag anywhere = TryDrag(nullptr);
  EXPECT_TRUE(anywhere.refined && anywhere.judged);
  const std::set<std::string> other{"friction"}, its{"viscous friction"};
  EXPECT_FALSE(TryDrag(&other).refined);
  const TriedDrag of_its_family = TryDrag(&its);
  EXPECT_TRUE(of_its_family.refined && of_its_family.judged);
}

TEST(Name, KinThatLeavesFarMoreIsExcluded) {
  Compared compared;
  EXPECT_THAT(compared.Named(), ElementsAre("hysteresis"));
}

TEST(Name, KinThatExtrapolatesBetterIsNotExcludedByShortSegments) {
  Compared compared;
  compared.presliding->alone = {0.4, 0.1, 0.1};
  EXPECT_THAT(compared.Named(), UnorderedElementsAre("hysteresis", "presliding_friction"));
  compared.presliding->alone = {0.4, 0.3, 0.1};
  EXPECT_THAT(compared.Named(), ElementsAre("hysteresis"));
}

TEST(Name, KinThatGainsTheSameIsNotExcludedByAnExactFormula) {
  Compared compared;
  compared.hysteresis->trial.with_flexible = compared.hysteresis->trial.alone;  // nothing flexible is left in it
  const double exact = compared.hysteresis->trial.fit.error_sd;
  compared.presliding->alone = {0.1004, 0.3, 0.3};
  EXPECT_THAT(compared.Named(exact), ElementsAre("hysteresis", "presliding_friction"));
  compared.presliding->alone = {0.102, 0.3, 0.3};
  EXPECT_THAT(compared.Named(exact), ElementsAre("hysteresis"));
}

TEST(Name, WhatFewEventsShowIsNotNamedIfOtherFamiliesWinMoreOften) {
  Compared compared;
  compared.hysteresis->gain_share = 0.96;
  compared.hysteresis->win_share = 0.3;
  EXPECT_THAT(compared.Named(), IsEmpty());
  compared.hysteresis->win_share = 0.6;
  EXPECT_THAT(compared.Named(), ElementsAre("hysteresis"));
  EXPECT_TRUE(compared.rung.provisional);
}

TEST(Shares, AFamilysIsCountedOnceAndSharedInATie) {
  Compared compared;
  EffectEntry relative = *compared.presliding->candidate.entry;
  relative.family = compared.hysteresis->candidate.entry->family;
  std::vector<Contender>& all = compared.rung.contenders;
  for (Contender& c : all) {
    if (c.candidate.entry->name == relative.name) c.candidate.entry = &relative;
    c.win_share = 0.9;
  }
  const auto index = [&](const Contender* c) { return static_cast<std::size_t>(c - all.data()); };
  const auto shares = [&](std::vector<std::size_t> named) {
    compared.rung.named = std::move(named);
    return SharesOf(compared.rung);
  };
  EXPECT_THAT(shares({index(compared.hysteresis)}),
              UnorderedElementsAre(Pair("hysteresis", 0.9), Pair("presliding_friction", 0.0)));
  EXPECT_THAT(shares({index(compared.hysteresis), index(compared.presliding)}),
              UnorderedElementsAre(Pair("hysteresis", 0.45), Pair("presliding_friction", 0.45)));
  EXPECT_THAT(shares({}), UnorderedElementsAre(Pair("hysteresis", 0.0), Pair("presliding_friction", 0.0)));
}

TEST(Climb, NothingIsNamedThatLeavesMoreThanTheOutputVaries) {
  // The sensor of a motor is off by a million: the speed begins there and decays, which a lag of the sensor slows down.
  const Dataset honest = test::MotorData([](double, double) { return 1.0; });
  auto series = std::make_shared<identify::Series>(*honest.series);
  for (double& w : series->signals[1]) w += 1e6;
  Dataset data = honest;
  data.series = series;
  PlantDescription plant = test::MotorPlant();
  plant.states[0].start = "w";
  const Ladder ladder = test::ClimbWith({"sensor_lag"}, data, plant);
  EXPECT_THAT(NamesOf(ladder.rungs[0]), IsEmpty());
  EXPECT_FALSE(ladder.complete);
}

}  // namespace
}  // namespace armcmc::ladder::climbs::naming_test
