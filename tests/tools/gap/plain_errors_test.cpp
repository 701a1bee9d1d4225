// Names that are not given: what is missing may be an error of the model or of its data.

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/plant_diagnosis.hpp"
#include "armcmc/gap/workflow.hpp"
#include "armcmc/ladder/second_search.hpp"
#include "tools/gap/actuator_rig.hpp"

namespace armcmc::gap::test::plain_errors_test {
namespace {

/// A recording of a contact with an effect, as the first 70 % of one that the workflow diagnoses.
Recording Contact(const std::string& effect, const std::string& variant, double gap_ratio, unsigned long long seed) {
  const Recording all = RecordPlant("contact_rich", {{effect, gap_ratio, {}, variant}}, seed, 10.0, true, true);
  return all.Slice(0, 7000);
}

PlantDiagnosis DiagnoseWithout(const std::string& effect, const Recording& recording) {
  DiagnoseOptions options;
  options.without = {effect};
  return DiagnosePlant("hunt_crossley", recording, options);
}

struct Case {
  const char *effect, *variant, *looks_like;
  double gap_ratio;
  unsigned long long seed;
};

class PlainError : public ::testing::TestWithParam<Case> {};

TEST_P(PlainError, CompetesThoughItIsExcludedFromTheCatalogue) {
  const Case& at = GetParam();
  const PlantDiagnosis plant = DiagnoseWithout(at.effect, Contact(at.effect, at.variant, at.gap_ratio, at.seed));
  const Finding& finding = plant.carrying().diagnosis.finding;
  EXPECT_EQ(finding.verdict, Verdict::kUnnamed);
  ASSERT_TRUE(finding.unlisted);
  EXPECT_EQ(finding.unlisted->names(), std::vector<std::string>{at.looks_like});
  // Beside it an effect is credited with its own gain only, and none of them gains anything.
  double unlisted = finding.p_unnamed;
  for (const CandidatePtr& candidate : finding.tried)
    if (!candidate->fit.hypothesis.terms.back().form->listed) unlisted += candidate->probability;
  EXPECT_GT(unlisted, 0.9);
}

INSTANTIATE_TEST_SUITE_P(
    Contact, PlainError,
    ::testing::Values(Case{"force_bias", "constant", "a zero of the force that is off", 1.0, 590662734},
                      Case{"force_drift", "linear", "a zero of the force that drifts", 3.0, 809991582},
                      Case{"stiffness_drift", "linear", "a stiffness that drifts", 0.3, 971003214}),
    [](const auto& at) { return std::string(at.param.effect); });

TEST(FlexibleCorrection, AFormulaThatBecomesAnotherEffectWithoutTheCorrectionIsNotNamed) {
  // Beside a law that may err, presliding is fitted within its bounds; without that it is a spring that never yields.
  const PlantDiagnosis plant =
      DiagnoseWithout("stress_relaxation", Contact("stress_relaxation", "linear", 1.0, 766258191));
  EXPECT_EQ(plant.carrying().diagnosis.finding.verdict, Verdict::kUnnamed);
}

TEST(FlexibleCorrection, ANameBesideItIsWithdrawnUnlessItIsSure) {
  // Beside a law that may err, presliding closes four fifths of the gap, and no other effect half of it.
  const PlantDiagnosis plant =
      DiagnoseWithout("stress_relaxation", Contact("stress_relaxation", "linear", 1.0, 532305238));
  const Finding& finding = plant.carrying().diagnosis.finding;
  EXPECT_EQ(finding.verdict, Verdict::kUnnamed);
  EXPECT_GE(finding.p_unnamed, 0.5);
}

TEST(TwoEffects, AreNotNamedUnlessTheyAreSure) {
  // Beside the delay, a limit of the sensor takes what the law errs by, and so does a contact that begins elsewhere.
  const Recording all =
      RecordPlant("contact_rich", {{"sensor_delay", 3.0, {}, "dead_time"}}, 930367289, 10.0, true, true, 0.01);
  const PlantDiagnosis plant = DiagnosePlant("hunt_crossley", all.Slice(0, 7000), {});
  EXPECT_EQ(plant.carrying().diagnosis.finding.verdict, Verdict::kUnnamed);
}

TEST(TwoEffects, ARelaxationAsShortAsADampingIsNone) {
  // What a lag errs by in place of a delay looks like a branch that forgets at once.
  const PlantDiagnosis plant = DiagnoseWithout("sensor_delay", Contact("sensor_delay", "dead_time", 3.0, 519950135));
  for (const std::vector<std::string>& names : NamesOf(plant.carrying().diagnosis.finding))
    EXPECT_EQ(names, std::vector<std::string>{"sensor_lag"});
}

TEST(SecondSearch, WhatExplainsLessIsNotNamedInPlaceOfWhatIsWithdrawn) {
  // Noise that neighbours share makes the held-out data contradict every friction; two branches explain half as much.
  WorkflowRequest request;
  request.model = "hunt_crossley";
  request.data = RecordPlant("contact_rich", {{"viscous_friction", 1.0, {}, "linear"}}, 894535750, 10.0, true, true);
  request.diagnose.without = {"viscous_friction"};
  EXPECT_FALSE(ladder::SearchAgain(request));
}

/// What the second search makes of a recording whose effect is taken out of the catalogue.
std::optional<ladder::SecondSearch> SearchAgainWithout(const std::string& effect, unsigned long long seed,
                                                       double gap_ratio = 1.0) {
  WorkflowRequest request;
  request.model = "hunt_crossley";
  request.data = RecordPlant("contact_rich", {{effect, gap_ratio, {}, "linear"}}, seed, 10.0, true, true);
  request.diagnose.without = {effect};
  return ladder::SearchAgain(request);
}

TEST(SecondSearch, ABodyThatRelaxesIsNoFrictionThatBuildsUp) {
  EXPECT_FALSE(SearchAgainWithout("stress_relaxation", 50909615));
}

TEST(SecondSearch, ABranchThatForgetsAtOnceIsNoRelaxation) {
  EXPECT_FALSE(SearchAgainWithout("viscous_friction", 624872630, 3.0));
}

TEST(SecondSearch, AFrictionThatIsStraightAsFarAsTheDataReachIsNotNamedDry) {
  EXPECT_FALSE(SearchAgainWithout("viscous_friction", 784671043));
}

}  // namespace
}  // namespace armcmc::gap::test::plain_errors_test
