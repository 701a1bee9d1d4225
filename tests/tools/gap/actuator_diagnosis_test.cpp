// What is hidden in the simulated actuator, named from its recordings alone.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "armcmc/gap/plant_diagnosis.hpp"
#include "armcmc/gap/workflow.hpp"
#include "support/paths.hpp"
#include "tools/gap/actuator_rig.hpp"
#include "tools/gap/findings.hpp"

namespace armcmc::gap::test::actuator_diagnosis_test {
namespace {

constexpr char kModel[] = "soft_actuator_excited";
constexpr double kSeconds = 8.0;

TEST(PlantDiagnosis, NamesNothingWhereNothingIsHidden) {
  const PlantDiagnosis plant = DiagnosePlant(kModel, RecordPlant(kModel, {}, 71, kSeconds));
  for (const EquationDiagnosis& one : plant.equations)
    EXPECT_EQ(one.diagnosis.finding.verdict, Verdict::kNone) << one.equation->name();
}

TEST(PlantDiagnosis, EstimatesALagThatIsShorterThanASample) {
  const Recording recording = RecordPlant(kModel, {{"valve_lag", 1.0, {0.26e-3}}}, 61, kSeconds);
  const PlantDiagnosis plant = DiagnosePlant(kModel, recording);
  const Finding& finding = plant.equations[0].diagnosis.finding;
  ASSERT_TRUE(SetHolds(finding, "valve_lag"));
  const Fitted& fit = finding.best->fit;
  EXPECT_NEAR(fit.coordinates.back().Value(fit.theta[fit.theta.size() - 1]), 0.26e-3, 0.03e-3);
}

TEST(PlantDiagnosis, FindsAnEffectInEachEquation) {
  const Recording recording = RecordPlant(kModel, {{"leak", 1.0, {}}, {"joint_friction", 1.0, {}}}, 62, kSeconds);
  const PlantDiagnosis plant = DiagnosePlant(kModel, recording);
  ASSERT_EQ(plant.Others().size(), 1u);
  const std::vector<std::vector<std::string>> both = {*NamesOf(plant.carrying().diagnosis.finding).begin(),
                                                      *NamesOf(plant.Others().front()->diagnosis.finding).begin()};
  EXPECT_TRUE(std::find(both.begin(), both.end(), std::vector<std::string>{"leak"}) != both.end());
  EXPECT_TRUE(std::find(both.begin(), both.end(), std::vector<std::string>{"joint_friction"}) != both.end());
}

TEST(PlantDiagnosis, HoldsTwoBiasesThatNothingTellsApartForEquallyProbable) {
  // It begins with the recording: what the state at the start hides must not favour one of them.
  const PlantDiagnosis plant = DiagnosePlant(kModel, RecordPlant(kModel, {{"pressure_bias", 2.0, {}}}, 69, kSeconds));
  const Finding& finding = plant.carrying().diagnosis.finding;
  for (const CandidatePtr& candidate : finding.set)
    if (candidate->families().front() == "sensor zero") {
      EXPECT_NEAR(candidate->probability, 0.5, 0.1) << candidate->names().front();
    }
  EXPECT_TRUE(SetHolds(finding, "pressure_bias"));
}

TEST(PlantDiagnosis, GivesProbabilitiesThatAreNumbersWhereARivalWouldRunAway) {
  // A load that triples the inertia: constants that explain its beginning have no stiffness left.
  const PlantDiagnosis plant =
      DiagnosePlant(kModel, RecordPlant(kModel, {{"payload_step", 1.0, {2.18, 0.35 * kSeconds}}}, 1, kSeconds));
  for (const EquationDiagnosis& one : plant.equations)
    for (const CandidatePtr& candidate : one.diagnosis.finding.tried) {
      EXPECT_TRUE(std::isfinite(candidate->probability)) << candidate->names().front();
      EXPECT_TRUE(std::isfinite(candidate->fit.score())) << candidate->names().front();
    }
}

TEST(PlantDiagnosis, SaysThatTheConstantsAreWrongRatherThanToNameAnEffect) {
  // The recording is of the excited plant; the angle is scaled as if q1 were 3 % larger.
  Recording recording = RecordPlant(kModel, {}, 64, kSeconds);
  recording.columns[5] *= 1.03;
  const PlantDiagnosis plant = DiagnosePlant(kModel, recording);
  const Finding& finding = plant.carrying().diagnosis.finding;
  EXPECT_EQ(plant.carrying().equation->name(), "bend equation");
  EXPECT_EQ(finding.verdict, Verdict::kUnnamed);
  ASSERT_TRUE(finding.unlisted);
  EXPECT_EQ(finding.unlisted->fit.hypothesis.terms[0].form->family, "constants");
}

TEST(ActuatorWorkflow, SaysWhichEquationAndWritesTheModelThatRuns) {
  WorkflowRequest request;
  request.model = kModel;
  request.data = RecordPlant(kModel, {{"leak", 1.0, {}}}, 65, kSeconds);
  const WorkflowOutcome outcome = RunWorkflow(request);
  const Result& result = outcome.result;
  EXPECT_EQ(result.verdict, Verdict::kNamed);
  EXPECT_EQ(result.equation, "flow law");
  EXPECT_NE(result.sentence.find("in the flow law: leak"), std::string::npos) << result.sentence;
  ASSERT_FALSE(result.where.empty());
  EXPECT_EQ(result.where.front().feature.rfind("flow law: ", 0), 0u) << result.where.front().feature;
  ASSERT_TRUE(outcome.augmented);
  EXPECT_EQ(outcome.augmented->num_effects, 1);
  EXPECT_EQ(outcome.augmented->effects[0].name, "leak");
  EXPECT_FALSE(result.effects.front().approximate) << "it is the catalogue's own formula";
  EXPECT_TRUE(std::none_of(result.notes.begin(), result.notes.end(),
                           [](const std::string& note) { return note.find("offline") != std::string::npos; }));
  EXPECT_GT(result.gap.closed_fraction, 0.9);
  EXPECT_EQ(result.gap.unit, "Pa/s");
}

TEST(ActuatorWorkflow, FindsAPayloadThatComesAfterThePartThatIsDiagnosed) {
  WorkflowRequest request;
  request.model = kModel;
  request.data = RecordPlant(kModel, {{"payload_step", 1.0, {1.0, 0.8 * kSeconds}}}, 67, kSeconds);
  const Result result = RunWorkflow(request).result;
  EXPECT_EQ(result.verdict, Verdict::kNamed);
  ASSERT_EQ(result.effects.size(), 1u);
  EXPECT_EQ(result.effects[0].name, "payload_step");
  EXPECT_NEAR(result.effects[0].parameters[0].mean, 1.0, 0.1);
  EXPECT_NEAR(result.effects[0].parameters[1].mean, 0.8 * kSeconds, 0.1);
  EXPECT_TRUE(std::any_of(result.notes.begin(), result.notes.end(), [](const std::string& note) {
    return note.find("no data were held out") != std::string::npos;
  }));
}

TEST(LongActuatorWorkflow, FindsAPayloadOfWhichThePartThatIsDiagnosedShowsTheBeginningOnly) {
  WorkflowRequest request;
  request.model = kModel;
  request.data = RecordPlant(kModel, {{"payload_step", 1.0, {3.0, 0.68 * kSeconds}}}, 68, kSeconds);
  const Result result = RunWorkflow(request).result;
  ASSERT_EQ(result.verdict, Verdict::kNamed) << result.sentence;
  EXPECT_EQ(result.effects[0].name, "payload_step");
  // While the pressure holds, half a second at a time, a load is not felt.
  EXPECT_NEAR(result.effects[0].parameters[1].mean, 0.68 * kSeconds, 0.5);
  EXPECT_TRUE(std::any_of(result.notes.begin(), result.notes.end(), [](const std::string& note) {
    return note.find("no data were held out") != std::string::npos;
  }));
}

TEST(ActuatorWorkflow, NamesNothingInAFlowLawThatIsNotExcitedAndProposesTheExcitation) {
  ARMCMC_REQUIRE_DATA("paper/soft_actuator.csv");
  WorkflowRequest request;
  request.model = "soft_actuator";
  request.data =
      ReadRecording(armcmc::test::FindData("paper/soft_actuator.csv")->string(), ColumnsOf("soft_actuator"), false);
  const Result result = RunWorkflow(request).result;
  EXPECT_EQ(result.verdict, Verdict::kNone);
  EXPECT_TRUE(result.effects.empty());
  EXPECT_NE(result.sentence.find("condition number"), std::string::npos) << result.sentence;
  EXPECT_NE(result.separate_by.scenario_text.find("pressure_steps"), std::string::npos);
}

TEST(ActuatorWorkflow, JudgesTheBendEquationOfARecordingThatDoesNotExciteTheFlowLaw) {
  const Recording recording = RecordPlant("soft_actuator_paper", {{"cubic_stiffness", 1.0, {300.0}}}, 66, 12.0);
  const PlantDiagnosis plant = DiagnosePlant("soft_actuator", recording);
  EXPECT_FALSE(plant.equations[0].suitability.can_name);
  EXPECT_EQ(plant.carrying().equation->name(), "bend equation");
  EXPECT_TRUE(SetHolds(plant.carrying().diagnosis.finding, "cubic_stiffness"));
}

}  // namespace
}  // namespace armcmc::gap::test::actuator_diagnosis_test
