#include <gtest/gtest.h>

#include <chrono>

#include "integration/live_pair.hpp"

namespace armcmc::test::realtime_live_test {
namespace {

using namespace std::chrono_literals;

class RealtimeLive : public LivePair {};

TEST_F(RealtimeLive, TheWholeEstimatorRunsWithoutAComplaintOfTheSanitizer) {
  auto estimator = StartEstimator({"--resume", dir_ / "learnt.snapshot", "--verbose"});
  auto plant = StartPlant("4");
  ASSERT_TRUE(recorder_->WaitForEstimates(20)) << estimator->err();
  EXPECT_EQ(plant->Wait(30s).code, 0) << plant->err();
  const Json report = Finish(estimator.get());  // a sanitizer would have another exit code
  EXPECT_GE(report["steps"], 20);
  EXPECT_GT(report["snapshot"]["written"], 0);
  EXPECT_EQ(estimator->err().find("Sanitizer"), std::string::npos) << estimator->err();
}

}  // namespace
}  // namespace armcmc::test::realtime_live_test
