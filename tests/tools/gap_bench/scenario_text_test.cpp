#include "armcmc/gap_bench/scenario_text.hpp"

#include <gtest/gtest.h>

namespace armcmc::gap_bench::scenario_text_test {
namespace {

constexpr const char* kScenario = "schema = 1\n[noise.f]\nstd = 0.1\n[noise.x]\nstd = 0.2\n";

TEST(ScenarioText, ReplacesOneTableAndLeavesTheOthers) {
  EXPECT_EQ(WithTable(kScenario, "noise.f", "std = 0.3"), "schema = 1\n[noise.x]\nstd = 0.2\n\n[noise.f]\nstd = 0.3\n");
}

TEST(ScenarioText, AddsATableThatIsNotThere) {
  EXPECT_EQ(WithTable("schema = 1\n", "noise.f", "std = 0.3\n"), "schema = 1\n\n[noise.f]\nstd = 0.3\n");
}

TEST(ScenarioText, DropsTablesAndTablesOfTablesByPrefix) {
  EXPECT_EQ(WithoutTables(kScenario, "noise."), "schema = 1\n");
  EXPECT_EQ(
      WithoutTables("a = 1\n[[hidden_effect]]\nname = \"x\"\n[hidden_effect.parameters]\nf = 1.0\n[motion]\nb = 2\n",
                    "hidden_effect"),
      "a = 1\n[motion]\nb = 2\n");
}

}  // namespace
}  // namespace armcmc::gap_bench::scenario_text_test
