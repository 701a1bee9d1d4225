#include "armcmc/gap_bench/score.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace armcmc::gap_bench::score_test {
namespace {

Truth Hidden(const Names& names, const std::string& kind = "catalogue") {
  Truth truth;
  for (const std::string& name : names) {
    TrueEffect effect;
    effect.name = name;
    effect.kind = kind;
    effect.gate = "always";
    truth.effects.push_back(effect);
  }
  return truth;
}

gap::Result Said(const std::vector<Names>& sets) {
  gap::Result result;
  result.verdict = sets.size() == 1 ? gap::Verdict::kNamed : gap::Verdict::kAmbiguous;
  for (const std::string& name : sets.front()) {
    gap::EffectFinding effect;
    effect.name = name;
    result.effects.push_back(effect);
  }
  if (sets.size() > 1) result.ambiguous_set = sets;
  return result;
}

gap::Result Said(gap::Verdict verdict) {
  gap::Result result;
  result.verdict = verdict;
  return result;
}

TEST(GradeOf, DataWithoutAnEffect) {
  const Truth nothing;
  EXPECT_EQ(GradeOf({}, nothing, Said(gap::Verdict::kNone)), Grade::kRight);
  EXPECT_EQ(GradeOf({}, nothing, Said(gap::Verdict::kUnnamed)), Grade::kUnnamed);
  EXPECT_EQ(GradeOf({}, nothing, Said({{"inertia"}})), Grade::kWrong);
}

TEST(GradeOf, OneEffectOfTheCatalogue) {
  const Truth truth = Hidden({"sensor_delay"});
  EXPECT_EQ(GradeOf({}, truth, Said({{"sensor_delay"}})), Grade::kRight);
  EXPECT_EQ(GradeOf({}, truth, Said({{"sensor_lag"}, {"sensor_delay"}})), Grade::kTie);
  EXPECT_EQ(GradeOf({}, truth, Said({{"sensor_lag"}})), Grade::kFamily);
  EXPECT_EQ(GradeOf({}, truth, Said({{"sensor_lag"}, {"inertia"}})), Grade::kWrong);
  EXPECT_EQ(GradeOf({}, truth, Said({{"inertia"}})), Grade::kWrong);
  EXPECT_EQ(GradeOf({}, truth, Said({{"sensor_delay", "inertia"}})), Grade::kWrong);
  EXPECT_EQ(GradeOf({}, truth, Said(gap::Verdict::kNone)), Grade::kNone);
  EXPECT_EQ(GradeOf({}, truth, Said(gap::Verdict::kUnnamed)), Grade::kUnnamed);
}

TEST(GradeOf, TwoEffectsInAnyOrder) {
  const Truth truth = Hidden({"inertia", "coulomb_friction"});
  EXPECT_EQ(GradeOf({}, truth, Said({{"coulomb_friction", "inertia"}})), Grade::kRight);
  EXPECT_EQ(GradeOf({}, truth, Said({{"inertia", "coulomb_friction"}})), Grade::kRight);
  EXPECT_EQ(GradeOf({}, truth, Said({{"inertia", "presliding_friction"}})), Grade::kFamily);
  EXPECT_EQ(GradeOf({}, truth, Said({{"inertia"}})), Grade::kPartial);
  EXPECT_EQ(GradeOf({}, truth, Said({{"inertia", "adhesion"}})), Grade::kWrong);
}

TEST(GradeOf, WhatTheCatalogueLacksHasNoRightName) {
  const Truth outside = Hidden({"backlash"}, "outside");
  EXPECT_EQ(GradeOf({}, outside, Said(gap::Verdict::kUnnamed)), Grade::kRight);
  EXPECT_EQ(GradeOf({}, outside, Said({{"contact_offset"}})), Grade::kWrong);
  EXPECT_EQ(GradeOf({}, Hidden({"strain_stiffening"}, "outside"), Said({{"drag"}})), Grade::kWrong);
  Case ablated;
  ablated.without = {"force_drift"};
  const Truth truth = Hidden({"force_drift"});
  EXPECT_EQ(GradeOf(ablated, truth, Said(gap::Verdict::kUnnamed)), Grade::kRight);
  EXPECT_EQ(GradeOf(ablated, truth, Said({{"force_bias"}})), Grade::kFamily);
  EXPECT_EQ(GradeOf(ablated, truth, Said({{"inertia"}})), Grade::kWrong);
}

TEST(GradeOf, WhatServesEveryPlantHasARightName) {
  const Truth ripple = Hidden({"spatial_ripple"}, "outside");
  EXPECT_EQ(GradeOf({}, ripple, Said({{"cogging"}})), Grade::kRight);
  EXPECT_EQ(GradeOf({}, ripple, Said({{"cogging"}, {"inertia"}})), Grade::kTie);
  EXPECT_EQ(GradeOf({}, ripple, Said({{"cogging", "inertia"}})), Grade::kWrong);
  EXPECT_EQ(GradeOf({}, ripple, Said({{"drag"}})), Grade::kWrong);
  EXPECT_TRUE(LabelRight({}, ripple, "cogging"));
  EXPECT_FALSE(LabelRight({}, ripple, "drag"));
  EXPECT_EQ(GradeOf({}, Hidden({"quadratic_drag"}, "outside"), Said({{"drag"}})), Grade::kRight);
  for (const char* spring : {"cubic_stiffness", "quadratic_stiffness"})
    EXPECT_EQ(GradeOf({}, Hidden({"strain_stiffening"}, "outside"), Said({{spring}})), Grade::kRight) << spring;
  // Beside what the plant's own catalogue has it may be named.
  Truth truth = Hidden({"coulomb_friction"});
  truth.effects.push_back(ripple.effects.front());
  EXPECT_EQ(GradeOf({}, truth, Said({{"coulomb_friction", "cogging"}})), Grade::kRight);
  EXPECT_EQ(GradeOf({}, truth, Said({{"coulomb_friction", "drag"}})), Grade::kWrong);
}

TEST(GradeOf, WhatTheCatalogueIsMadeToLackHasTheNameOfTheSamePhysics) {
  const Truth dahl = Hidden({"presliding_friction"});
  Case ablated;
  ablated.without = {"presliding_friction"};
  EXPECT_EQ(GradeOf(ablated, dahl, Said({{"hysteresis"}})), Grade::kRight);
  EXPECT_EQ(GradeOf({}, dahl, Said({{"hysteresis"}})), Grade::kWrong);
}

TEST(GradeOf, AFamilyMayBeNamedByTwoOfItsEffectsWhereThePlantIsNotTheCatalogue) {
  Case imperfect;
  imperfect.stratum = "strokes";
  const gap::Result both = Said({{"sensor_delay", "sensor_lag"}});
  EXPECT_EQ(GradeOf(imperfect, Hidden({"sensor_delay"}), both), Grade::kFamily);
  EXPECT_EQ(GradeOf({}, Hidden({"sensor_delay"}), both), Grade::kWrong)
      << "where the law is exact one of them is false";
  EXPECT_EQ(GradeOf(imperfect, Hidden({"sensor_delay"}), Said({{"sensor_delay", "inertia"}})), Grade::kWrong);
  EXPECT_EQ(GradeOf(imperfect, Hidden({"coulomb_friction", "presliding_friction"}), Said({{"coulomb_friction"}})),
            Grade::kPartial);
}

TEST(GradeOf, ANameThatIsGivenTwiceIsOne) {
  EXPECT_EQ(GradeOf({}, Hidden({"adhesion"}), Said({{"adhesion", "adhesion"}})), Grade::kRight);
  EXPECT_EQ(GradeOf({}, Hidden({"adhesion"}), Said({{"adhesion", "adhesion", "inertia"}})), Grade::kWrong);
}

TEST(GradeOf, WhatNoCatalogueListsNeedsNoNameBesideWhatOneDoes) {
  Truth truth = Hidden({"coulomb_friction"});
  truth.effects.push_back(Hidden({"backlash"}, "outside").effects.front());
  EXPECT_EQ(GradeOf({}, truth, Said({{"coulomb_friction"}})), Grade::kRight);
  EXPECT_EQ(GradeOf({}, truth, Said({{"inertia"}, {"coulomb_friction"}})), Grade::kTie);
  EXPECT_EQ(GradeOf({}, truth, Said({{"presliding_friction"}})), Grade::kFamily);
  EXPECT_EQ(GradeOf({}, truth, Said({{"coulomb_friction", "contact_offset"}})), Grade::kWrong);
  EXPECT_EQ(GradeOf({}, truth, Said(gap::Verdict::kUnnamed)), Grade::kUnnamed);
  EXPECT_TRUE(LabelRight({}, truth, "coulomb_friction"));
  EXPECT_FALSE(LabelRight({}, truth, "unnamed"));
}

TEST(LabelRight, ARelativeWillDoWhereThePlantIsNotTheCatalogue) {
  Case what;
  what.stratum = "singles";
  EXPECT_FALSE(LabelRight(what, Hidden({"sensor_delay"}), "sensor_lag"));
  what.stratum = "law_error";
  EXPECT_TRUE(LabelRight(what, Hidden({"sensor_delay"}), "sensor_lag"));
  EXPECT_FALSE(LabelRight(what, Hidden({"sensor_delay"}), "inertia"));
}

TEST(LabelRight, WhatIsMissingFollowsFromTheSizeOfTheModelError) {
  Case what;
  what.stratum = "near_null";
  EXPECT_TRUE(LabelRight(what, {}, "none", 0.02));
  EXPECT_FALSE(LabelRight(what, {}, "unnamed", 0.02));
  EXPECT_FALSE(LabelRight(what, {}, "none", 0.05));
  EXPECT_TRUE(LabelRight(what, {}, "unnamed", 0.05));
  EXPECT_FALSE(LabelRight(what, {}, "inertia", 0.05));
}

TEST(GradeOf, WhatARealRecordingHoldsByItselfIsNotJudgedBesideWhatIsHidden) {
  Case real;
  real.own = {"periodic_disturbance"};
  const Truth truth = Hidden({"inertia"});
  EXPECT_EQ(GradeOf(real, truth, Said({{"inertia", "periodic_disturbance"}})), Grade::kRight);
  EXPECT_EQ(GradeOf(real, truth, Said({{"inertia", "periodic_disturbance"}, {"inertia"}})), Grade::kRight);
  EXPECT_EQ(GradeOf(real, truth, Said({{"adhesion", "periodic_disturbance"}, {"inertia"}})), Grade::kTie);
  EXPECT_EQ(GradeOf(real, truth, Said({{"adhesion", "periodic_disturbance"}})), Grade::kWrong);
  EXPECT_EQ(GradeOf(real, truth, Said({{"periodic_disturbance"}})), Grade::kNone);
  EXPECT_EQ(GradeOf({}, truth, Said({{"inertia", "periodic_disturbance"}})), Grade::kWrong);
  const Truth wave = Hidden({"periodic_disturbance"});
  EXPECT_EQ(GradeOf(real, wave, Said({{"periodic_disturbance"}})), Grade::kRight);
  EXPECT_EQ(GradeOf(real, wave, Said({{"adhesion"}})), Grade::kWrong);
  const Truth nothing;
  EXPECT_EQ(GradeOf(real, nothing, Said({{"periodic_disturbance"}})), Grade::kRight);
  EXPECT_EQ(GradeOf(real, nothing, Said({{"adhesion", "periodic_disturbance"}})), Grade::kWrong);
  EXPECT_EQ(GradeOf(real, nothing, Said(gap::Verdict::kUnnamed)), Grade::kUnnamed);
  EXPECT_TRUE(LabelRight(real, truth, "inertia + periodic_disturbance"));
  EXPECT_FALSE(LabelRight({}, truth, "inertia + periodic_disturbance"));
  EXPECT_TRUE(LabelRight(real, nothing, "periodic_disturbance"));
  EXPECT_FALSE(LabelRight({}, nothing, "periodic_disturbance"));
}

TEST(GradeOf, EffectsOfTheActuatorHaveFamiliesOfTheirOwnCatalogue) {
  const Truth truth = Hidden({"joint_friction"}, "variant");
  EXPECT_EQ(GradeOf({}, truth, Said({{"joint_friction"}})), Grade::kRight);
  EXPECT_EQ(GradeOf({}, truth, Said({{"hysteresis"}})), Grade::kWrong);
  EXPECT_EQ(GradeOf({}, Hidden({"pressure_bias"}), Said({{"angle_bias"}})), Grade::kFamily);
  gap::Result result = Said({{"leak"}});
  result.probability_none = 0.0;
  result.candidates = {{{"leak"}, 0, 0, 0.6, 0}, {{"other constants"}, 0, 0, 0.4, 0}};
  EXPECT_EQ(TopLabel(result), (std::pair<std::string, double>{"leak", 0.6}));
}

TEST(EquationRight, IsThatWhichTheEffectChanges) {
  gap::Result flow = Said({{"leak"}}), bend = Said({{"angle_bias"}});
  flow.equation = "flow law";
  bend.equation = "bend equation";
  EXPECT_EQ(EquationRight(Hidden({"leak"}), flow), true);
  EXPECT_EQ(EquationRight(Hidden({"leak"}), bend), false);
  EXPECT_EQ(EquationRight(Hidden({"sensor_delay"}), flow), false);
  EXPECT_EQ(EquationRight(Hidden({"sensor_delay"}), bend), true);
  // Both read the pressure.
  EXPECT_EQ(EquationRight(Hidden({"pressure_bias"}), flow), true);
  EXPECT_EQ(EquationRight(Hidden({"pressure_bias"}), bend), true);
  EXPECT_EQ(EquationRight(Hidden({"obstacle"}, "outside"), bend), std::nullopt);
  EXPECT_EQ(EquationRight({}, bend), std::nullopt);
  EXPECT_EQ(EquationRight(Hidden({"inertia"}), Said({{"inertia"}})), std::nullopt);
  gap::Result silent = Said(gap::Verdict::kNone);
  silent.equation = "flow law";
  EXPECT_EQ(EquationRight(Hidden({"leak"}), silent), std::nullopt);
}

TEST(TopLabel, AddsUpFormulasAndTimesAndCallsUnlistedPhysicsUnnamed) {
  gap::Result result = Said({{"inertia"}});
  result.probability_none = 0.0;
  result.candidates = {{{"inertia"}, 0, 0, 0.3, 0},
                       {{"inertia from 3 s"}, 0, 0, 0.2, 0},
                       {{"adhesion (pull_off)"}, 0, 0, 0.35, 0},
                       {{"a ripple along the path"}, 0, 0, 0.15, 0}};
  EXPECT_EQ(TopLabel(result).first, "inertia");
  EXPECT_NEAR(TopLabel(result).second, 0.5, 1e-12);
  result.probability_unnamed = 0.4;
  EXPECT_EQ(TopLabel(result).first, "unnamed");
}

TEST(LabelRight, ARelativeCountsWhereTheFormulaIsNotInTheCatalogue) {
  EXPECT_TRUE(LabelRight({}, {}, "none"));
  EXPECT_FALSE(LabelRight({}, Hidden({"inertia"}), "none"));
  EXPECT_TRUE(LabelRight({}, Hidden({"inertia", "adhesion"}), "adhesion + inertia"));
  EXPECT_FALSE(LabelRight({}, Hidden({"sensor_lag"}), "sensor_delay"));
  EXPECT_TRUE(LabelRight({}, Hidden({"sensor_lag"}, "variant"), "sensor_delay"));
  EXPECT_TRUE(LabelRight({}, Hidden({"backlash"}, "outside"), "unnamed"));
  EXPECT_FALSE(LabelRight({}, Hidden({"inertia"}), "unnamed"));
}

TEST(OnsetInterval, ReachesAsFarAsTheEffectLeavesNoTrace) {
  // Ten samples a second; nothing is felt from 3.0 s to 5.0 s.
  std::vector<double> contribution(100, 10.0);
  for (std::size_t i = 30; i < 50; ++i) contribution[i] = 0.0;
  const auto [first, last] = OnsetInterval(contribution, 0.1, 4.0, 1.0);
  EXPECT_NEAR(first, 3.0, 1e-12);
  EXPECT_NEAR(last, 5.0, 1e-12);
  const auto sharp = OnsetInterval(contribution, 0.1, 7.0, 1.0);
  EXPECT_NEAR(sharp.first, 7.0, 1e-12);
  EXPECT_NEAR(sharp.second, 7.0, 1e-12);
  // Each sample brings 4 noise variances: the third would pass 9.
  const auto weak = OnsetInterval(std::vector<double>(100, 2.0), 0.1, 5.0, 1.0);
  EXPECT_NEAR(weak.first, 4.8, 1e-12);
  EXPECT_NEAR(weak.second, 5.2, 1e-12);
}

TEST(OnsetError, CountsFromTheEdgesOfTheInterval) {
  gap::Result result = Said({{"inertia"}});
  EXPECT_FALSE(OnsetError(result, "inertia", {3.0, 5.0}));
  result.effects.front().when = {gap::When::Kind::kFrom, 5.5};
  EXPECT_NEAR(OnsetError(result, "inertia", {3.0, 5.0}).value(), 0.5, 1e-12);
  result.effects.front().when.time_s = 4.0;
  EXPECT_EQ(OnsetError(result, "inertia", {3.0, 5.0}).value(), 0.0);
  EXPECT_FALSE(OnsetError(result, "adhesion", {3.0, 5.0}));
}

}  // namespace
}  // namespace armcmc::gap_bench::score_test
