// More of what is hidden in the simulated actuator. Every diagnosis fits every effect of the catalogue, so that these
// walk through the code of actuator_diagnosis_test.cpp, over other recordings.

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "armcmc/gap/plant_diagnosis.hpp"
#include "tools/gap/actuator_rig.hpp"
#include "tools/gap/findings.hpp"

namespace armcmc::gap::test::actuator_recovery_test {
namespace {

constexpr char kModel[] = "soft_actuator_excited";
constexpr double kSeconds = 8.0;

struct Case {
  const char* effect;
  const char* equation;
  bool alone;  ///< Nothing else explains it as well in this motion.
};

class Recovery : public ::testing::TestWithParam<Case> {};

TEST_P(Recovery, NamesWhatIsHiddenInItsOwnEquation) {
  const Recording recording = RecordPlant(kModel, {{GetParam().effect, 1.0, {}}}, 61, kSeconds);
  const PlantDiagnosis plant = DiagnosePlant(kModel, recording);
  const Finding& finding = plant.carrying().diagnosis.finding;
  EXPECT_EQ(plant.carrying().equation->name(), GetParam().equation);
  EXPECT_TRUE(SetHolds(finding, GetParam().effect));
  if (GetParam().alone) {
    EXPECT_EQ(finding.verdict, Verdict::kNamed);
  }
  EXPECT_TRUE(plant.Others().empty());
}

// The other effects of the catalogue are named in actuator_diagnosis_test.cpp.
INSTANTIATE_TEST_SUITE_P(
    Actuator, Recovery,
    ::testing::Values(Case{"valve_dead_band", "flow law", true}, Case{"supply_droop", "flow law", true},
                      Case{"hysteresis", "bend equation", true}, Case{"gravity_load", "bend equation", false},
                      Case{"sensor_delay", "bend equation", true}, Case{"periodic_disturbance", "bend equation", true}),
    [](const auto& at) { return std::string(at.param.effect); });

TEST(LongActuatorRecovery, LetsTheFlowLawDecideBetweenTheTwoBiases) {
  // A constant bias of either sensor bends the actuator alike: only the vent flow tells them apart. 1500 Pa change it
  // at 15 kPa by 5 %; the same offset of the angle leaves it alone.
  const Recording pressure = RecordPlant(kModel, {{"pressure_bias", 1.0, {1500.0}}}, 63, kSeconds);
  const PlantDiagnosis one = DiagnosePlant(kModel, pressure);
  EXPECT_EQ(NamesOf(one.carrying().diagnosis.finding), (std::set<std::vector<std::string>>{{"pressure_bias"}}));
  EXPECT_GT(one.carrying().diagnosis.finding.best->probability, 0.95);
  const Recording angle = RecordPlant(kModel, {{"angle_bias", 1.0, {0.0318}}}, 63, kSeconds);
  const PlantDiagnosis other = DiagnosePlant(kModel, angle);
  EXPECT_TRUE(SetHolds(other.carrying().diagnosis.finding, "angle_bias"));
  EXPECT_FALSE(SetHolds(other.carrying().diagnosis.finding, "pressure_bias"));
  EXPECT_GT(other.carrying().diagnosis.finding.best->probability, 0.95);
}

}  // namespace
}  // namespace armcmc::gap::test::actuator_recovery_test
