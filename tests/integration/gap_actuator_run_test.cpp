// What the soft actuator hides, from the plant through the workflow into the programs that run the model it writes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "integration/files.hpp"
#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::gap_actuator_run_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct Case {
  std::string effect, parameter;
};

class ActuatorModel : public ::testing::TestWithParam<Case> {
 protected:
  static Outcome Run(const char* program, const std::vector<std::string>& arguments) {
    Outcome o = RunProgram(Program(program), arguments);
    EXPECT_EQ(o.code, 0) << program << ": " << o.err;
    return o;
  }
  Outcome Replay(const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"--config", (SourceDir() / "rt/config/soft_actuator_excited.toml").string(),
                                          "--data",   dir_ / "run.csv",
                                          "--out",    dir_ / (name + ".csv")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Run("armcmc-replay", arguments);
  }
  /// Last row of a CSV file by column.
  std::map<std::string, double> LastRow(const std::string& name) {
    std::map<std::string, double> row;
    for (const auto& [column, values] : ReadTable(dir_ / name))
      row[column] = std::strtod(values.back().c_str(), nullptr);
    return row;
  }
  /// Last row of a plant of two seconds.
  std::map<std::string, double> Plant(const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {
        "--scenario", "soft_actuator_excited", "--seed", "3", "--duration", "2", "--csv", dir_ / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Run("armcmc-plant", arguments);
    return LastRow(name);
  }
  [[nodiscard]] Json Read(const std::string& name) const { return ReadJson(dir_ / name); }

  ScratchDir dir_;
};

TEST_P(ActuatorModel, ThatTheWorkflowWritesRunsEverywhereAndTheGapIsGone) {
  const auto& [effect, parameter] = GetParam();
  Run("armcmc-plant", {"--scenario", "soft_actuator_excited", "--hide-effect", effect, "--effect-strength", "2",
                       "--seed", "3", "--duration", "20", "--csv", dir_ / "run.csv", "--sealed", dir_ / "truth.json"});
  Run("armcmc-gap",
      {"--model", "soft_actuator_excited", "--data", dir_ / "run.csv", "--out", dir_ / "gap", "--seed", "1"});
  const std::string model = dir_ / "gap/model.toml";
  const Json result = Read("gap/result.json");
  EXPECT_EQ(result["verdict"], "named");
  EXPECT_EQ(result["effects"][0]["name"], effect);
  EXPECT_GT(result["gap"]["closed_fraction"], 0.9);
  EXPECT_GT(result["budget"]["adjust_ms_after"], 0.0);
  EXPECT_LT(result["budget"]["adjust_ms_after"], 100.0);

  // In the replay.
  const std::string column = effect + "_" + parameter + "_u_c";
  const double truth = Read("truth.json")["effects"][0]["parameters"][parameter]["value"];
  const Outcome before = Replay("before", {});
  EXPECT_THAT(before.out, HasSubstr("GAP SUSPECTED"));
  const Outcome after = Replay("after", {"--model", model});
  EXPECT_THAT(after.out, HasSubstr("none suspected"));
  EXPECT_THAT(after.out, Not(HasSubstr("GAP SUSPECTED")));
  const auto row = LastRow("after.csv");
  ASSERT_TRUE(row.contains(column)) << column;
  EXPECT_NEAR(row.at(column), truth, 5.0 * row.at(column + "_sd"));
  EXPECT_LT(row.at(column + "_sd"), 0.05 * truth);
  const double g = -2.14e-4 + 6.12e-9 * 101'325.0;
  EXPECT_NEAR(row.at("g_u_c"), g, 5.0 * row.at("g_u_c_sd"));
  const auto base = LastRow("before.csv");
  EXPECT_GT(std::fabs(base.at("g_u_c") - g), 10.0 * std::fabs(row.at("g_u_c") - g));

  // In the plant.
  EXPECT_NE(Plant("with.csv", {"--model", model}).at("p"), Plant("without.csv", {}).at("p"));

  // In the workflow: what it has found is not to be found again.
  Run("armcmc-gap", {"--model", model, "--data", dir_ / "run.csv", "--out", dir_ / "again", "--seed", "1"});
  EXPECT_EQ(Read("again/result.json")["verdict"], "none");
}

INSTANTIATE_TEST_SUITE_P(Flow, ActuatorModel, ::testing::Values(Case{"leak", "rate"}),
                         [](const auto& at) { return at.param.effect; });
INSTANTIATE_TEST_SUITE_P(LongFlow, ActuatorModel,
                         ::testing::Values(Case{"valve_dead_band", "width"}, Case{"supply_droop", "droop"}),
                         [](const auto& at) { return at.param.effect; });

}  // namespace
}  // namespace armcmc::test::gap_actuator_run_test
