#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <string>

#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::stress_faults_test {
namespace {

using namespace std::chrono_literals;

TEST(StressFaults, DetectsEveryFaultOfAShortRun) {
  ARMCMC_REQUIRE_MULTICAST();
  const ScratchDir dir;
  const std::string report = dir / "stress.json", page = dir / "stress.html";
  const Outcome run = RunProgram(
      Program("armcmc-stress"),
      {"--minutes", "0.4", "--load", "cpu", "--inject", "nan,lost,hang_adjust,overload,log_disk_full,plant_death",
       "--report", report, "--html", page, "--work", dir / "work"},
      120s);
  ASSERT_TRUE(std::filesystem::exists(report)) << run.err;
  const Json json = ReadJson(report);
  ASSERT_EQ(json["faults"].size(), 6U) << run.out;
  for (const Json fault : json["faults"]) {
    EXPECT_GE(fault["injected"], 1) << fault;
    EXPECT_EQ(fault["detected"], fault["injected"]) << fault;
    EXPECT_LE(fault["recovered_steps"], 5) << fault;
  }
  ASSERT_EQ(json["phases"].size(), 1U);
  EXPECT_EQ(json["phases"][0]["load"], "cpu");
  // In a log file, too, one sees how far it is.
  EXPECT_NE(run.err.find("stress: phase 1 of 1, load cpu: " + json["phases"][0]["steps"].dump() + " steps"),
            std::string::npos)
      << run.err;
  EXPECT_GT(json["phases"][0]["rss_kb"]["end"], 0);
  EXPECT_EQ(json["phases"][0]["rt"]["degraded"].back(), "injected_faults");
  EXPECT_GT(std::filesystem::file_size(page), 10'000U);
}

}  // namespace
}  // namespace armcmc::test::stress_faults_test
