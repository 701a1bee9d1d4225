// A real recording on the bus: the running estimator notices what its model misses, and armcmc-gap names it from the
// data that the estimator kept.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "integration/described_story.hpp"
#include "support/paths.hpp"

namespace armcmc::test::gap_recorded_live_test {
namespace {

class RecordedStory : public DescribedStory {};

TEST_F(RecordedStory, FrictionOfARealAxisIsNoticedAndNamed) {
  ARMCMC_REQUIRE_DATA("measured/emps_estimation.csv");
  const std::filesystem::path data = FindData("measured/emps_estimation.csv")->parent_path();
  const Outcome made =
      RunProgram(Program("armcmc-plant"),
                 {"--recording", (SourceDir() / "tools/gap/recordings/emps_estimation.toml").string(), "--data-dir",
                  data.string(), "--lcm-url", "memq://", "--speed", "1e4", "--log", dir_ / "run.log"});
  ASSERT_EQ(made.code, 0) << made.err;
  const Json gap = Watched(dir_ / "run.log", 248);
  ASSERT_EQ(gap["suspected"], true) << gap.dump();
  EXPECT_EQ(gap["where"], "direction_of_v");
  const Json result = Diagnosed(gap);
  EXPECT_EQ(result["verdict"], "named");
  ASSERT_FALSE(result["ladder"].empty());
  EXPECT_EQ(result["ladder"][0]["effects"][0], "coulomb_friction");
}

}  // namespace
}  // namespace armcmc::test::gap_recorded_live_test
