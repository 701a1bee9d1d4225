// Names that are not given: what is missing may be an error of the model or of its data, or physics without a name.

#include <gtest/gtest.h>

#include "armcmc/gap/plant_diagnosis.hpp"
#include "tools/gap/actuator_rig.hpp"

namespace armcmc::gap::test::plain_errors_test {
namespace {

TEST(Hedge, AnUncertainNameIsWithdrawnWherePhysicsWithoutANameBelongsToTheSet) {
  // As if q3 were a thousandth smaller: a weight explains it by chance as well as the constants.
  Recording recording = RecordPlant("soft_actuator_excited", {}, 2, 14.0);
  recording.columns[5] *= 0.999;
  const PlantDiagnosis plant = DiagnosePlant("soft_actuator_excited", recording);
  EXPECT_EQ(plant.carrying().diagnosis.finding.verdict, Verdict::kUnnamed);
}

}  // namespace
}  // namespace armcmc::gap::test::plain_errors_test
