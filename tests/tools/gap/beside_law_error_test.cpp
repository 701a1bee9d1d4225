// Names where the law errs by a tenth, three times as much as the effect adds or more.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "armcmc/gap/plant_diagnosis.hpp"
#include "armcmc/gap/workflow.hpp"
#include "tools/gap/actuator_rig.hpp"

namespace armcmc::gap::test::beside_law_error_test {
namespace {

constexpr double kLawError = 0.1;

/// Effects with the values, in SI units, that make up three times the noise.
struct Case {
  const char *effect, *variant;
  std::vector<double> values;
  unsigned long long seed;
};
const Case kFriction = {"coulomb_friction", "tanh", {0.018679, 0.073248}, 997703};
const Case kMass = {"inertia", "rigid", {1.2022e-4}, 997706};
const Case kRelaxation = {"stress_relaxation", "linear", {0.091921, 0.17330}, 997709};
const Case kOffset = {"contact_offset", "shift", {-0.030637}, 997711};
const Case kDisturbance = {"periodic_disturbance", "sine", {0.010887, 3.97502, 4.98781}, 997713};

WorkflowRequest Contact(const Case& at, bool with_effect = true) {
  std::vector<HiddenInPlant> hidden;
  if (with_effect) hidden.push_back({at.effect, 0.0, at.values, at.variant});
  WorkflowRequest request;
  request.model = "hunt_crossley";
  request.data = RecordPlant("contact_rich", hidden, at.seed, 10.0, true, true, kLawError);
  return request;
}

/// Whether no effect is named, before any of the rest of the data is looked at.
bool NothingStandsOut(const WorkflowRequest& request) {
  constexpr double kDiagnosed = 0.7;
  DiagnoseOptions options = request.diagnose;
  options.law_errs = true;
  const auto rows = static_cast<Eigen::Index>(kDiagnosed * static_cast<double>(request.data.rows()));
  return DiagnosePlant(request.model, request.data.Slice(0, rows), options).carrying().diagnosis.finding.set.empty();
}

class BesideLawError : public ::testing::TestWithParam<Case> {};

TEST_P(BesideLawError, TheEffectIsNamedAndMeasured) {
  const Case& at = GetParam();
  const auto outcome = RunBesideLawError(Contact(at));
  ASSERT_TRUE(outcome);
  const Result& result = outcome->result;
  EXPECT_EQ(result.verdict, Verdict::kNamed);
  ASSERT_EQ(result.effects.size(), 1U);
  EXPECT_EQ(result.effects[0].name, at.effect);
  EXPECT_FALSE(result.complete) << "the error of the law remains";
  EXPECT_NEAR(std::abs(result.effects[0].parameters.front().mean) / at.values.front(), 1.0, 0.1);
  EXPECT_TRUE(outcome->augmented);
}

INSTANTIATE_TEST_SUITE_P(Contact, BesideLawError, ::testing::Values(kFriction, kMass, kRelaxation, kDisturbance),
                         [](const auto& at) { return std::string(at.param.effect); });

TEST(BesideLawErrorAlone, NothingIsNamedWhereNothingIsHidden) {
  for (const Case& at : {kFriction, kRelaxation}) EXPECT_FALSE(RunBesideLawError(Contact(at, false))) << at.seed;
}

TEST(BesideLawErrorAlone, NothingIsNamedInPlaceOfTheTruth) {
  WorkflowRequest request = Contact(kRelaxation);
  request.diagnose.without = {"stress_relaxation"};
  EXPECT_FALSE(RunBesideLawError(request));
}

TEST(BesideLawErrorAlone, AContactThatBeginsElsewhereIsNoDamping) {
  // It is the most probable of what is left, but others explain nearly as much.
  for (const unsigned long long seed : {997703ULL, 997707ULL}) {
    WorkflowRequest request;
    request.model = "hunt_crossley";
    request.data = RecordPlant("contact_rich", {{"viscous_friction", 3.0, {}, {}}}, seed, 10.0, true, true, kLawError);
    request.diagnose.without = {"viscous_friction"};
    EXPECT_TRUE(NothingStandsOut(request)) << seed;
  }
}

TEST(BesideLawErrorAlone, NothingIsNamedWhereOthersExplainAsMuch) {
  // A contact that begins elsewhere bends the law as its error does.
  EXPECT_FALSE(RunBesideLawError(Contact(kOffset)));
}

TEST(BesideLawErrorAlone, NothingIsNamedWhereEffectsAreErrorsOfTheLaw) {
  WorkflowRequest request;
  request.model = "soft_actuator";
  request.data = RecordPlant("soft_actuator_excited", {{"leak", 3.0, {}}}, 5, 12.0);
  EXPECT_FALSE(RunBesideLawError(request));
}

TEST(BesideLawErrorAlone, NeedsAWholeSearchOfOneRecording) {
  WorkflowRequest request = Contact(kFriction);
  request.until = Step::kName;
  EXPECT_FALSE(RunBesideLawError(request));
  request.until = Step::kShow;
  request.earlier = request.data;
  EXPECT_FALSE(RunBesideLawError(request));
}

}  // namespace
}  // namespace armcmc::gap::test::beside_law_error_test
