// What the soft actuator hides, from the plant through the workflow into the programs that run the model it writes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test {
namespace {

using nlohmann::json;
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
  /// The folder of a recording in which the effect is hidden and what the workflow made of it; the same for all tests.
  static const ScratchDir& Recorded(const std::string& effect) {
    static std::map<std::string, ScratchDir> folders;
    const bool is_new = !folders.contains(effect);
    const ScratchDir& dir = folders[effect];
    if (is_new) {
      Run("armcmc-plant",
          {"--scenario", "soft_actuator_excited", "--hide-effect", effect, "--effect-strength", "2", "--seed", "3",
           "--duration", "20", "--csv", dir / "run.csv", "--sealed", dir / "truth.json"});
      Run("armcmc-gap",
          {"--model", "soft_actuator_excited", "--data", dir / "run.csv", "--out", dir / "gap", "--seed", "1"});
    }
    return dir;
  }
  Outcome Replay(const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"--config", (SourceDir() / "rt/config/soft_actuator_excited.toml").string(),
                                          "--data",   data_,
                                          "--out",    dir_ / (name + ".csv")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Run("armcmc-replay", arguments);
  }
  /// Last row of a CSV file by column.
  std::map<std::string, double> LastRow(const std::string& name) {
    std::ifstream file(dir_ / name);
    std::string header, line, last;
    std::getline(file, header);
    while (std::getline(file, line)) last = line;
    std::istringstream names(header), cells(last);
    std::map<std::string, double> row;
    for (std::string key, cell; std::getline(names, key, ',') && std::getline(cells, cell, ',');)
      row[key] = std::strtod(cell.c_str(), nullptr);
    return row;
  }
  [[nodiscard]] json Json(const std::string& name) const { return json::parse(std::ifstream(dir_ / name)); }

  const ScratchDir& dir_ = Recorded(GetParam().effect);
  std::string data_ = dir_ / "run.csv";
};

TEST_P(ActuatorModel, TheModelRunsInReplayAndTheGapIsGone) {
  const std::string column = GetParam().effect + "_" + GetParam().parameter + "_u_c";
  const double truth = Json("truth.json")["effects"][0]["parameters"][GetParam().parameter]["value"];
  const Outcome before = Replay("before", {});
  EXPECT_THAT(before.out, HasSubstr("GAP SUSPECTED"));
  const Outcome after = Replay("after", {"--model", dir_ / "gap/model.toml"});
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
}

TEST_P(ActuatorModel, TheWorkflowSaysWhatTheModelCosts) {
  const json result = Json("gap/result.json");
  EXPECT_EQ(result["verdict"], "named");
  EXPECT_EQ(result["effects"][0]["name"], GetParam().effect);
  EXPECT_GT(result["gap"]["closed_fraction"], 0.9);
  EXPECT_GT(result["budget"]["adjust_ms_after"], 0.0);
  EXPECT_LT(result["budget"]["adjust_ms_after"], 100.0);
}

TEST_P(ActuatorModel, ThePlantRunsIt) {
  const auto plant = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {
        "--scenario", "soft_actuator_excited", "--seed", "3", "--duration", "2", "--csv", dir_ / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Run("armcmc-plant", arguments);
    return LastRow(name);
  };
  EXPECT_NE(plant("with.csv", {"--model", dir_ / "gap/model.toml"}).at("p"), plant("without.csv", {}).at("p"));
}

// What a workflow has found is not to be found again.
TEST_P(ActuatorModel, WithTheModelTheWorkflowFindsNothing) {
  Run("armcmc-gap", {"--model", dir_ / "gap/model.toml", "--data", data_, "--out", dir_ / "again", "--seed", "1"});
  EXPECT_EQ(Json("again/result.json")["verdict"], "none");
}

INSTANTIATE_TEST_SUITE_P(Flow, ActuatorModel,
                         ::testing::Values(Case{"leak", "rate"}, Case{"valve_dead_band", "width"},
                                           Case{"supply_droop", "droop"}),
                         [](const auto& at) { return at.param.effect; });

}  // namespace
}  // namespace armcmc::test
