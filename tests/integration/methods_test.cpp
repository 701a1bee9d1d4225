#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "integration/live_pair.hpp"

namespace armcmc::test {
namespace {

using namespace std::chrono_literals;

class Methods : public LivePair, public ::testing::WithParamInterface<std::string> {};

// The baselines stand behind the estimator's interface: they run in the same process, under the same rules.
TEST_P(Methods, RunsLiveWithoutTheHeapAndRepeatsToTheBit) {
  std::ifstream shipped(SourceDir() / "rt/config/hunt_crossley.toml");
  const std::string text{std::istreambuf_iterator<char>(shipped), std::istreambuf_iterator<char>()};
  const std::string path = dir_ / "estimator.toml";
  const std::string changed =
      std::regex_replace(text, std::regex("\nmethod = \"armcmc\""), "\nmethod = \"" + GetParam() + "\"");
  ASSERT_NE(changed, text);
  std::ofstream(path) << changed;
  config_ = path;
  auto estimator = StartEstimator();
  auto plant = StartPlant("3");
  ASSERT_EQ(plant->Wait(60s).code, 0) << plant->err();
  ASSERT_TRUE(recorder_->WaitForEstimates(30)) << estimator->err();
  const nlohmann::json report = Finish(estimator.get());
  EXPECT_EQ(report["steps"], 30);
  for (const char* stage : {"collect", "adjust", "execute"}) EXPECT_EQ(report["allocations"][stage], 0) << stage;
  const Outcome replay =
      RunProgram(Program("armcmc-replay"), {"--data", Log(), "--config", path, "--verify"}, std::chrono::minutes(1));
  EXPECT_EQ(replay.code, 0) << replay.out << replay.err;
}

INSTANTIATE_TEST_SUITE_P(Baselines, Methods, ::testing::Values("rls", "pf", "mcmc"),
                         [](const auto& at) { return at.param; });

}  // namespace
}  // namespace armcmc::test
