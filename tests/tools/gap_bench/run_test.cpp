#include "armcmc/gap_bench/run.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "armcmc/gap_bench/report.hpp"
#include "support/paths.hpp"

namespace armcmc::gap_bench::run_test {
namespace {

TEST(RunCase, AHalfOfARecordingIsAllThatTheToolIsGiven) {
  const test::ScratchDir folder;
  const PlantProcess plant(test::Program("armcmc-plant"), folder.path());
  Case what;
  what.scenario = "contact_rich";
  what.effect = "inertia:rigid";
  for (const auto& [part, rows] :
       std::vector<std::pair<Part, long long>>{{Part::kFirstHalf, 5'000}, {Part::kSecondHalf, 5'001}}) {
    what.part = part;
    const Outcome outcome = RunCase(plant, what, false);
    EXPECT_EQ(outcome.answer.result.rows, rows) << outcome.answer.error;
    EXPECT_EQ(outcome.grade, Grade::kRight) << Line(outcome);
  }
}

TEST(RunCase, WhereThePlantIsNotTheCatalogueTheFirstRungIsHeldAgainstWhatTheTruthCloses) {
  const test::ScratchDir folder;
  const PlantProcess plant(test::Program("armcmc-plant"), folder.path());
  Case what;
  what.stratum = "strokes";
  what.scenario = "contact_rich";
  what.effect = "inertia:rigid";
  const Outcome outcome = RunCase(plant, what, false);
  ASSERT_EQ(outcome.grade, Grade::kRight) << Line(outcome);
  ASSERT_TRUE(outcome.first_rung.has_value());
  EXPECT_NEAR(*outcome.first_rung, 1.0, 0.02);
  EXPECT_FALSE(CanFollowUp(outcome));
}

}  // namespace
}  // namespace armcmc::gap_bench::run_test
