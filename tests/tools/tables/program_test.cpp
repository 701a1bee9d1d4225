// armcmc-tables as a user runs it.

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/file_text.hpp"

namespace armcmc::tables::program_test {
namespace {

using test::Json;

TEST(LongTablesProgram, ShowsTheCoverageAloneOfSeedsThatAreAskedFor) {
  const test::ScratchDir folder;
  const auto run = [&](const char* first_seed) {
    const test::Outcome outcome = test::RunProgram(
        test::Program("armcmc-tables"),
        {"--coverage", "--seeds", "1", "--first-seed", first_seed, "--out", (folder / first_seed).string()},
        std::chrono::minutes(2));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return test::Json::Parse(test::TextOf(folder / first_seed / "tables.json")).at("likelihoods");
  };
  const test::Json one = run("40001"), other = run("40101");
  EXPECT_EQ(one.size(), 4u);
  for (const std::string& noise : one.keys()) {
    EXPECT_EQ(one.at(noise).size(), 1u) << noise;
    EXPECT_EQ(one.at(noise).at(noise).at("seeds"), 1);
    const auto force = [&noise](const test::Json& one_run) {
      return one_run.at(noise).at(noise).at("clean_force_mae_mN");
    };
    EXPECT_NE(force(one), force(other)) << noise;
  }
}

TEST(TablesProgram, WithoutBaselinesNothingIsSaidOfThem) {
  const test::ScratchDir folder;
  const test::Outcome outcome = test::RunProgram(test::Program("armcmc-tables"),
                                                 {"--paper-only", "--armcmc-only", "--out", (folder / "out").string()});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const test::Json tables = test::Json::Parse(test::TextOf(folder / "out/tables.json"));
  for (const char* plant : {"hunt_crossley", "soft_actuator"})
    EXPECT_EQ(tables.at(plant).at("methods").size(), 2u) << plant << ": the two points of ARMCMC";
  EXPECT_FALSE(tables.contains("rows_lost"));
  EXPECT_EQ(outcome.out.find("ahead of every other"), std::string::npos);
  EXPECT_EQ(test::TextOf(folder / "out/report.html").find("ahead of every other"), std::string::npos);
}

TEST(TablesProgram, SaysWhatADataFolderMustHold) {
  const test::ScratchDir folder;
  const test::Outcome outcome = test::RunProgram(
      test::Program("armcmc-tables"), {"--data", (folder / "none").string(), "--out", (folder / "out").string()});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  EXPECT_NE(outcome.err.find("hunt_crossley.csv"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace armcmc::tables::program_test
