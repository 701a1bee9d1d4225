#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::stress_program_test {
namespace {

TEST(StressProgram, WithoutFaultsOnePlantRunsForTheWholeTime) {
  ARMCMC_REQUIRE_MULTICAST();
  const ScratchDir dir;
  const std::string report = dir / "stress.json";
  const Outcome run = RunProgram(Program("armcmc-stress"), {"--minutes", "0.1", "--load", "none", "--inject", "none",
                                                            "--report", report, "--work", dir / "work"});
  ASSERT_TRUE(std::filesystem::exists(report)) << run.err;
  const Json json = ReadJson(report);
  EXPECT_TRUE(json["faults"].empty());
  EXPECT_EQ(json["phases"][0]["plant"]["restarts"], 0);
  EXPECT_GT(json["phases"][0]["steps"], 30);
  // In a log file, too, one sees how far it is.
  EXPECT_NE(run.err.find("stress: phase 1 of 1, load none: "), std::string::npos) << run.err;
  EXPECT_TRUE(json["phases"][0]["rt"]["degraded"].empty() ||
              json["phases"][0]["rt"]["degraded"][0] != "injected_faults");
}

TEST(StressProgram, NamesWhatItDoesNotKnow) {
  const Outcome fault = RunProgram(Program("armcmc-stress"), {"--inject", "explode"});
  EXPECT_EQ(fault.code, 2);
  EXPECT_NE(fault.err.find("explode"), std::string::npos);
  EXPECT_EQ(RunProgram(Program("armcmc-stress"), {"--load", "gravity"}).code, 2);
  EXPECT_EQ(RunProgram(Program("armcmc-stress"), {"--minutes", "0"}).code, 2);
}

}  // namespace
}  // namespace armcmc::test::stress_program_test
