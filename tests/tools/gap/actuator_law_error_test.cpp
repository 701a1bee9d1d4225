// The soft actuator where the law of its valves errs: what is named all the same.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "armcmc/gap/plant_diagnosis.hpp"
#include "armcmc/gap/workflow.hpp"
#include "tools/gap/actuator_rig.hpp"
#include "tools/gap/findings.hpp"

namespace armcmc::gap::test::actuator_law_error_test {
namespace {

constexpr char kModel[] = "soft_actuator_excited";

/// An effect with the values, in SI units, that make up three times the noise, and the error of the law.
struct Case {
  const char *effect, *variant;
  std::vector<double> values;
  unsigned long long seed;
  double law_error;
};
const Case kLeak = {"leak", "linear", {0.05446402}, 929192042, 0.01};
const Case kLoad = {"payload_step", "inertia", {3.879438, 15.992269}, 29944849, 0.01};
const Case kFriction = {"joint_friction", "tanh", {22.06034, 0.139544}, 438683819, 0.1};

WorkflowRequest RequestOf(const Case& at) {
  WorkflowRequest request;
  request.model = kModel;
  request.data =
      RecordPlant(kModel, {{at.effect, 0.0, at.values, at.variant}}, at.seed, 20.0, true, true, at.law_error);
  return request;
}

TEST(ActuatorLawError, IsNotASecondEffect) {
  const Result result = RunWorkflow(RequestOf(kLeak)).result;
  ASSERT_EQ(result.effects.size(), 1U) << result.sentence;
  EXPECT_EQ(result.effects[0].name, "leak");
  EXPECT_FALSE(result.complete) << "the error of the law remains";
}

TEST(ActuatorLawError, DoesNotHideANameInTheOtherEquation) {
  const PlantDiagnosis plant = DiagnosePlant(kModel, RequestOf(kFriction).data);
  EXPECT_EQ(plant.carrying().equation->name(), "bend equation");
  EXPECT_TRUE(SetHolds(plant.carrying().diagnosis.finding, "joint_friction"));
  ASSERT_EQ(plant.Others().size(), 1U);
  EXPECT_EQ(plant.Others().front()->diagnosis.finding.verdict, Verdict::kUnnamed);
  EXPECT_GT(plant.Others().front()->diagnosis.finding.gap, plant.carrying().diagnosis.finding.gap);
}

TEST(ActuatorLawError, DoesNotHideALoadThatIsPickedUpLate) {
  const Result result = RunWorkflow(RequestOf(kLoad)).result;
  EXPECT_EQ(result.equation, "bend equation");
  ASSERT_EQ(result.effects.size(), 1U) << result.sentence;
  EXPECT_EQ(result.effects[0].name, "payload_step");
}

}  // namespace
}  // namespace armcmc::gap::test::actuator_law_error_test
