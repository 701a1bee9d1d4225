#include <gtest/gtest.h>

#include <chrono>

#include "integration/live_pair.hpp"

namespace armcmc::test {
namespace {

using namespace std::chrono_literals;

class RealtimeLive : public LivePair {};

TEST_F(RealtimeLive, TheWholeEstimatorMakesNoCallThatMayBlockInItsStages) {
  auto estimator = StartEstimator();
  auto plant = StartPlant("4");
  ASSERT_TRUE(recorder_->WaitForEstimates(35)) << estimator->err();
  EXPECT_EQ(plant->Wait(30s).code, 0) << plant->err();
  const nlohmann::json report = Finish(estimator.get());  // the sanitizer's exit code would be 43
  EXPECT_GE(report["steps"], 35);
  EXPECT_EQ(estimator->err().find("RealtimeSanitizer"), std::string::npos) << estimator->err();
}

}  // namespace
}  // namespace armcmc::test
