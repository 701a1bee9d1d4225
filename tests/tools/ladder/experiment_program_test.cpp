// The whole way of a tie on a plant that a file describes: the motion that the workflow proposes, made by the simulated
// plant as it was written, and both recordings judged together.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::experiment_program_test {
namespace {

using ::testing::HasSubstr;

/// At one constant speed a ripple over time and one along the way are the same.
constexpr const char* kOneWay = R"(schema = 1
rate_hz = 100
duration_s = 20
seed = 11
[truth]
M = 100.0
Fv = 180.0
off = 2.0
[inputs]
q = { expression = "0.02*t" }
[noise]
law = "gaussian"
std = 2.0
)";

std::string Read(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

class ExperimentProgram : public ::testing::TestWithParam<std::pair<const char*, const char*>> {
 protected:
  [[nodiscard]] std::filesystem::path Simulate(const std::string& name, const std::string& scenario) const {
    std::ofstream(dir_ / (name + ".toml")) << scenario;
    const Outcome run = RunProgram(Program("armcmc-plant"), {"--model", "servo_axis", "--scenario",
                                                             dir_ / (name + ".toml"), "--csv", dir_ / (name + ".csv")});
    EXPECT_EQ(run.code, 0) << run.err;
    return dir_ / (name + ".csv");
  }
  [[nodiscard]] Json Gap(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--model", "servo_axis", "--out", dir_ / "out"});
    const Outcome run = RunProgram(Program("armcmc-gap"), arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return ReadJson(dir_ / "out" / "result.json");
  }
  ScratchDir dir_;
};

TEST_P(ExperimentProgram, DecidesWhatTheRecordingLeavesOpen) {
  const auto& [truth, hidden] = GetParam();
  const std::string term = "[[hidden]]\nslot = \"output\"\nvalue = \"" + std::string(hidden) + "\"\n";
  const std::filesystem::path first = Simulate("first", kOneWay + term);
  const Json open = Gap({"--data", first});
  ASSERT_EQ(open["verdict"], "ambiguous");
  ASSERT_EQ(open["ambiguous_set"].size(), 2u);
  EXPECT_THAT(open["separate_by"].text(), HasSubstr("(scenario file: experiment.toml)"));
  EXPECT_GT(open["experiment"]["nats"].number(), 10.0);
  EXPECT_LT(open["seconds"]["experiment"].number(), 0.5 * open["seconds"]["all"].number());
  EXPECT_THAT(Read(dir_ / "out" / "report.html"), HasSubstr("The proposed motion."));

  const std::string proposed = Read(dir_ / "out" / "experiment.toml");
  static_cast<void>(Simulate("as_written", proposed));
  const std::filesystem::path second = Simulate("second", proposed + term);
  const Json decided = Gap({"--data", second, "--earlier", first});
  EXPECT_EQ(decided["verdict"], "named");
  EXPECT_EQ(decided["effects"][0]["name"], truth);
  EXPECT_EQ(decided["complete"], true);
  EXPECT_FALSE(std::filesystem::exists(dir_ / "out" / "experiment.toml"));
}

INSTANTIATE_TEST_SUITE_P(Ripples, ExperimentProgram,
                         ::testing::Values(std::pair("cogging", "6*sin(q/0.01)"),
                                           std::pair("periodic_disturbance", "6*sin(2*t)")),
                         [](const auto& test) { return std::string(test.param.first); });

}  // namespace
}  // namespace armcmc::test::experiment_program_test
