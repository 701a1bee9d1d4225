#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <string>

#include "armcmc/estimator_status_t.hpp"
#include "integration/live_pair.hpp"

namespace armcmc::test::restart_test {
namespace {

using namespace std::chrono_literals;

class Restart : public LivePair {};

TEST_F(Restart, AKilledPlantIsNoticedWithinTwoStepsAndANewOneContinues) {
  auto estimator = StartEstimator();
  auto plant = StartPlant("60");
  ASSERT_TRUE(recorder_->WaitForEstimates(20)) << estimator->err();
  plant->Signal(SIGKILL);
  EXPECT_EQ(plant->Wait(5s).signal, SIGKILL);

  // By the estimator's words, and by its messages: the first one that flags the silence.
  EXPECT_TRUE(estimator->WaitForErr("plant has been silent", 10s)) << estimator->err();
  const auto silent = [this]() {
    for (const estimator_status_t& status : recorder_->statuses())
      if ((status.fault_flags & estimator_status_t::FAULT_PLANT_SILENT) != 0 && status.last_seq > 0) return status;
    return estimator_status_t{};
  };
  ASSERT_TRUE(recorder_->WaitUntil([&] { return silent().period_ns > 0; }));
  const estimator_status_t first = silent();
  // Stalls of the machine are not ours; the witness has measured them.
  EXPECT_LE(first.t_status_ns - recorder_->last_pack_ns(), 2 * first.period_ns + first.witness_max_ns);
  const estimate_t learnt = recorder_->estimates().back();

  auto second = StartPlant("1");
  ASSERT_TRUE(recorder_->WaitUntil([&] {
    const auto all = recorder_->estimates();
    return all.back().run_id != learnt.run_id && all.back().seq >= 10;
  })) << estimator->err();
  EXPECT_EQ(second->Wait(30s).code, 0);
  EXPECT_TRUE(estimator->WaitForErr("plant was restarted", 1s)) << estimator->err();

  const auto all = recorder_->estimates();
  const auto again =
      std::find_if(all.begin(), all.end(), [&](const estimate_t& e) { return e.run_id != learnt.run_id; });
  ASSERT_NE(again, all.end());
  EXPECT_EQ(again->known, 1) << "what was learnt is kept";
  // Not the sd: it holds the small probability that the plant changed meanwhile, which is far out.
  EXPECT_LE(again->q75[0] - again->q25[0], 2.0 * (learnt.q75[0] - learnt.q25[0]));
  const Json report = Finish(estimator.get());
  EXPECT_EQ(report["plant"]["restarts"], 1);
  EXPECT_EQ(report["packs"]["lost"], 0);
}

TEST_F(Restart, AKilledEstimatorIsNoticedByThePlantAndANewOneTakesOver) {
  auto estimator = StartEstimator();
  auto plant = StartPlant("60");
  ASSERT_TRUE(recorder_->WaitForEstimates(8)) << estimator->err();
  estimator->Signal(SIGKILL);
  EXPECT_EQ(estimator->Wait(5s).signal, SIGKILL);
  EXPECT_TRUE(plant->WaitForErr("the estimator is silent", 10s)) << plant->err();

  const std::size_t before = recorder_->estimates().size();
  auto second = StartEstimator();
  ASSERT_TRUE(recorder_->WaitUntil([&] {
    const auto all = recorder_->estimates();
    return all.size() >= before + 5 && all.back().known == 1;
  })) << second->err();
  EXPECT_TRUE(plant->WaitForErr("the estimator answers again", 10s)) << plant->err();
  plant->Signal(SIGINT);
  EXPECT_EQ(plant->Wait(30s).code, 0) << plant->err();
  const Json report = Finish(second.get());
  EXPECT_EQ(report["packs"]["lost"], 0) << "packs from before its start are not lost";
}

}  // namespace
}  // namespace armcmc::test::restart_test
