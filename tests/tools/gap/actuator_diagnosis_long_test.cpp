// More recordings of the simulated actuator than the diagnosis is tried on every time: what goes wrong with one seed in
// a few shows here.

#include <gtest/gtest.h>

#include <cmath>

#include "armcmc/gap/plant_diagnosis.hpp"
#include "tools/gap/actuator_rig.hpp"
#include "tools/gap/findings.hpp"

namespace armcmc::gap::test::actuator_diagnosis_long_test {
namespace {

constexpr char kModel[] = "soft_actuator_excited";
constexpr double kSeconds = 8.0;

TEST(ManyActuatorRecordings, NameNothingWhereNothingIsHidden) {
  for (const unsigned long long seed : {72u, 73u}) {
    const PlantDiagnosis plant = DiagnosePlant(kModel, RecordPlant(kModel, {}, seed, kSeconds));
    for (const EquationDiagnosis& one : plant.equations)
      EXPECT_EQ(one.diagnosis.finding.verdict, Verdict::kNone) << one.equation->name() << ", seed " << seed;
  }
}

TEST(ManyActuatorRecordings, GiveProbabilitiesThatAreNumbersWhereARivalWouldRunAway) {
  // A load that triples the inertia: constants that explain its beginning have no stiffness left.
  for (const unsigned long long seed : {2u, 3u}) {
    const PlantDiagnosis plant =
        DiagnosePlant(kModel, RecordPlant(kModel, {{"payload_step", 1.0, {2.18, 0.35 * kSeconds}}}, seed, kSeconds));
    for (const EquationDiagnosis& one : plant.equations)
      for (const CandidatePtr& candidate : one.diagnosis.finding.tried) {
        EXPECT_TRUE(std::isfinite(candidate->probability)) << candidate->names().front() << ", seed " << seed;
        EXPECT_TRUE(std::isfinite(candidate->fit.score())) << candidate->names().front() << ", seed " << seed;
      }
  }
}

TEST(ManyActuatorRecordings, LeaveTwoBiasesThatNothingTellsApartEquallyProbable) {
  // It begins with the recording: what the state at the start hides must not favour one of them.
  const PlantDiagnosis plant = DiagnosePlant(kModel, RecordPlant(kModel, {{"angle_bias", 2.0, {}}}, 69, kSeconds));
  const Finding& finding = plant.carrying().diagnosis.finding;
  for (const CandidatePtr& candidate : finding.set)
    if (candidate->families().front() == "sensor zero") {
      EXPECT_NEAR(candidate->probability, 0.5, 0.1) << candidate->names().front();
    }
  EXPECT_TRUE(SetHolds(finding, "angle_bias"));
}

}  // namespace
}  // namespace armcmc::gap::test::actuator_diagnosis_long_test
