#include <gtest/gtest.h>

#include <chrono>
#include <regex>
#include <string>

#include "integration/live_pair.hpp"

namespace armcmc::test::methods_test {
namespace {

class Methods : public LivePair, public ::testing::WithParamInterface<std::string> {};

// The baselines stand behind the estimator's interface: they run in the same process, under the same rules.
TEST_P(Methods, RunsLiveWithoutTheHeapAndRepeatsToTheBit) {
  const std::string changed =
      std::regex_replace(ShippedConfig(), std::regex("\nmethod = \"armcmc\""), "\nmethod = \"" + GetParam() + "\"");
  ASSERT_NE(changed, ShippedConfig());
  UseConfig(changed);
  auto estimator = StartEstimator();
  ASSERT_EQ(Play("3"), 30u) << estimator->err();
  const Json report = Finish(estimator.get());
  EXPECT_EQ(report["steps"], 30);
  for (const char* stage : {"collect", "adjust", "execute"}) EXPECT_EQ(report["allocations"][stage], 0) << stage;
  const Outcome replay =
      RunProgram(Program("armcmc-replay"), {"--data", Log(), "--config", config_, "--verify"}, std::chrono::minutes(1));
  EXPECT_EQ(replay.code, 0) << replay.out << replay.err;
}

INSTANTIATE_TEST_SUITE_P(Baselines, Methods, ::testing::Values("rls", "pf", "mcmc"),
                         [](const auto& at) { return at.param; });

}  // namespace
}  // namespace armcmc::test::methods_test
