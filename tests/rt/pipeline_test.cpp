#include "armcmc/rt/pipeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "armcmc/change_t.hpp"
#include "armcmc/estimate_t.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "armcmc/posterior_t.hpp"
#include "armcmc/rt/allocation_counter.hpp"
#include "armcmc/rt/clock.hpp"
#include "fake_engine.hpp"
#include "report.hpp"
#include "support/json.hpp"
#include "support/paths.hpp"
#include "test_bus.hpp"
#include "test_packs.hpp"

namespace armcmc::rt::pipeline_test {
namespace {

/// Everything published on one channel, decoded.
template <typename Message>
class Listener {
 public:
  Listener(const std::string& url, const std::string& channel)
      : receiver_(ParseLcmUrl(url), std::vector<std::string>{channel}) {}
  const std::vector<Message>& Poll() {
    Datagram datagram;
    while (receiver_.TryReceive(&datagram)) {
      messages_.emplace_back();
      EXPECT_GT(messages_.back().decode(datagram.payload.data(), 0, static_cast<int>(datagram.payload.size())), 0);
    }
    return messages_;
  }

 private:
  LcmReceiver receiver_;
  std::vector<Message> messages_;
};

class PipelineTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ARMCMC_REQUIRE_MULTICAST();
    settings_.lcm_url = bus_.url();
    settings_.prefix = "T_";
    settings_.lock_memory = false;
    settings_.period_ns = 50 * kNanosPerMilli;
    settings_.deadline_ns = 500 * kNanosPerMilli;  // wide: what a test is not about must not be decided by the machine
    settings_.adjust_budget_ns = 20 * kNanosPerMilli;
    peer_ = std::make_unique<test::Peer>(bus_.url());
    statuses_ = std::make_unique<Listener<estimator_status_t>>(bus_.url(), "T_EST_STATUS");
    estimates_ = std::make_unique<Listener<estimate_t>>(bus_.url(), "T_EST_ESTIMATE");
    posteriors_ = std::make_unique<Listener<posterior_t>>(bus_.url(), "T_EST_POSTERIOR");
    changes_ = std::make_unique<Listener<change_t>>(bus_.url(), "T_EST_CHANGE");
  }

  void StartPipeline(std::int64_t max_steps = 0) {
    PipelineOptions options;
    options.max_steps = max_steps;
    if (HeapCallsAreCounted()) options.heap_probe = &ThreadHeapCalls;
    pipeline_ = std::make_unique<Pipeline>(settings_, &engine_, options);
    pipeline_->Start();
    // Collect has begun when the first status says that it waits.
    ASSERT_TRUE(WaitFor([this] { return !statuses_->Poll().empty(); }));
  }

  void Publish(const data_pack_t& pack) { peer_->Publish("T_PLANT_PACK", test::Encode(pack)); }

  static bool WaitFor(const std::function<bool()>& condition) {
    for (const Nanos end = MonotonicNow() + test::kLong; MonotonicNow() < end;
         SleepUntil(MonotonicNow() + kNanosPerMilli)) {
      if (condition()) return true;
    }
    return false;
  }
  bool WaitForSteps(std::int64_t steps) {
    return WaitFor([this, steps] { return pipeline_->lane().counters().execute.steps.Get() >= steps; });
  }
  void Stop() {
    pipeline_->RequestStop();
    pipeline_->Join();
  }
  std::int64_t Misses(MissCause cause) const { return pipeline_->lane().monitor().misses(cause); }

  armcmc::test::TestBus bus_;
  RtSettings settings_;
  test::FakeEngine engine_;
  std::unique_ptr<test::Peer> peer_;
  std::unique_ptr<Listener<estimator_status_t>> statuses_;
  std::unique_ptr<Listener<estimate_t>> estimates_;
  std::unique_ptr<Listener<posterior_t>> posteriors_;
  std::unique_ptr<Listener<change_t>> changes_;
  std::unique_ptr<Pipeline> pipeline_;
};

TEST_F(PipelineTest, AnswersEveryPackWithEstimatePosteriorChangeAndStatus) {
  StartPipeline();
  for (std::int64_t seq = 1; seq <= 5; ++seq) {
    Publish(test::ValidPack(seq));
    ASSERT_TRUE(WaitForSteps(seq));
  }
  ASSERT_TRUE(WaitFor([this] {
    return estimates_->Poll().size() == 5 && posteriors_->Poll().size() == 5 && changes_->Poll().size() == 5;
  }));
  Stop();
  for (std::size_t i = 0; i < 5; ++i) {
    const estimate_t& estimate = estimates_->Poll()[i];
    EXPECT_EQ(estimate.seq, static_cast<std::int64_t>(i) + 1);
    EXPECT_EQ(estimate.ar_map[0], static_cast<double>(i + 1)) << "the result of that pack";
    EXPECT_DOUBLE_EQ(estimate.y_pred, 9.9);
    EXPECT_GE(estimate.t_done_ns, estimate.t_release_ns);
    EXPECT_EQ(posteriors_->Poll()[i].seq, estimate.seq);
    EXPECT_EQ(changes_->Poll()[i].seq, estimate.seq);
  }
  const estimator_status_t& last = statuses_->Poll().back();
  EXPECT_EQ(last.step, 5);
  EXPECT_EQ(last.last_seq, 5);
  EXPECT_EQ(last.packs_received, 5);
  EXPECT_EQ(last.packs_lost, 0);
  EXPECT_NE(last.degraded_flags & estimator_status_t::DEGRADED_NO_MLOCK, 0) << "not locked here, and it says so";
  // 0 also where a sanitizer owns malloc and nothing is counted; the next test tells the two apart.
  for (const Counter& calls : pipeline_->lane().counters().heap_calls) EXPECT_EQ(calls.Get(), 0);
}

TEST_F(PipelineTest, CountsAHeapCallInAStage) {
  if (!HeapCallsAreCounted()) GTEST_SKIP() << "a sanitizer owns malloc; heap calls are not counted in this build";
  StartPipeline();
  engine_.planted = test::Planted::kAllocation;
  Publish(test::ValidPack(1));
  ASSERT_TRUE(WaitForSteps(1));
  Stop();
  EXPECT_EQ(pipeline_->lane().counters().heap_calls[IndexOf(Stage::kAdjust)].Get(), 2) << "one allocation, one release";
  EXPECT_EQ(pipeline_->lane().counters().heap_calls[IndexOf(Stage::kExecute)].Get(), 0);
}

TEST_F(PipelineTest, GoesOnPublishingItsStatusWhileThePlantIsSilent) {
  StartPipeline();
  Publish(test::ValidPack(1));
  ASSERT_TRUE(WaitForSteps(1));
  ASSERT_TRUE(WaitFor([this] { return statuses_->Poll().back().silent_periods >= 3; }));
  EXPECT_NE(statuses_->Poll().back().fault_flags & estimator_status_t::FAULT_PLANT_SILENT, 0);
  Publish(test::ValidPack(1, /*run_id=*/2));
  ASSERT_TRUE(WaitForSteps(2));
  ASSERT_TRUE(WaitFor([this] { return statuses_->Poll().back().step == 2; }));
  Stop();
  EXPECT_EQ(statuses_->Poll().back().plant_restarts, 1);
  const auto flags_restart = [](const estimator_status_t& status) {
    return (status.fault_flags & estimator_status_t::FAULT_PLANT_RESTARTED) != 0;
  };
  const std::vector<estimator_status_t>& all = statuses_->Poll();
  EXPECT_EQ(std::count_if(all.begin(), all.end(), flags_restart), 1) << "told once";
  EXPECT_EQ(engine_.adjusted.load(), 2) << "the engine was not reset";
  EXPECT_EQ(Misses(MissCause::kLateData), 0) << "silence is no miss";
}

TEST_F(PipelineTest, AnOverrunOfAStageIsAMissOfOurOwn) {
  settings_.deadline_ns = 30 * kNanosPerMilli;
  StartPipeline();
  engine_.adjust_sleep_ns = 130 * kNanosPerMilli;
  for (std::int64_t seq = 1; seq <= 3; ++seq) {
    Publish(test::ValidPack(seq, /*run_id=*/seq));  // each its own run: none is late on a grid
    ASSERT_TRUE(WaitForSteps(seq));
  }
  Stop();
  // A miss of the machine would need a stall of 100 ms in every step.
  EXPECT_EQ(Misses(MissCause::kOwn) + Misses(MissCause::kMachine), 3);
  EXPECT_GE(Misses(MissCause::kOwn), 1);
  EXPECT_EQ(Misses(MissCause::kLateData), 0);
  EXPECT_GE(pipeline_->lane().monitor().stage_overruns(Stage::kAdjust), 3);
}

TEST_F(PipelineTest, APackThatComesAfterItsDeadlineIsLateData) {
  StartPipeline();
  Publish(test::ValidPack(1));
  ASSERT_TRUE(WaitForSteps(1));
  SleepUntil(MonotonicNow() + settings_.period_ns + 2 * settings_.deadline_ns);
  Publish(test::ValidPack(2));
  ASSERT_TRUE(WaitForSteps(2));
  Stop();
  EXPECT_EQ(Misses(MissCause::kLateData), 1);
}

TEST_F(PipelineTest, StopsByItselfAfterTheNumberOfSteps) {
  StartPipeline(/*max_steps=*/2);
  for (std::int64_t seq = 1; seq <= 2; ++seq) {
    Publish(test::ValidPack(seq));
    ASSERT_TRUE(WaitForSteps(seq));
  }
  ASSERT_TRUE(WaitFor([this] { return pipeline_->stopping(); }));
  pipeline_->Join();
  EXPECT_EQ(pipeline_->lane().counters().execute.steps.Get(), 2);
  ASSERT_EQ(estimates_->Poll().size(), 2U) << "finished steps are published before the end";
}

TEST_F(PipelineTest, ReportsWithTheAgreedKeys) {
  StartPipeline();
  for (std::int64_t seq = 1; seq <= 3; ++seq) Publish(test::ValidPack(seq));
  ASSERT_TRUE(WaitForSteps(3));
  Stop();
  const auto report = armcmc::test::Json::Parse(ReportJson(*pipeline_, pipeline_->lane()));
  EXPECT_EQ(report.at("schema"), 1);
  EXPECT_EQ(report.at("steps"), 3);
  EXPECT_EQ(report.at("period_ms"), 50.0);
  EXPECT_EQ(report.at("deadline_ms"), 500.0);
  for (const char* cause : {"own", "machine", "late_data"}) EXPECT_TRUE(report.at("misses").contains(cause));
  for (const char* stage : {"collect", "adjust", "execute", "end_to_end"}) {
    for (const char* q : {"p50", "p99", "p999", "max"}) EXPECT_TRUE(report.at("stage_ms").at(stage).at(q).is_number());
  }
  for (const char* stage : {"collect", "adjust", "execute"}) {
    EXPECT_EQ(report.at("waiting_ms").at(stage).at("count"), 3);
    EXPECT_EQ(report.at("allocations").at(stage).is_number(), HeapCallsAreCounted());
  }
  EXPECT_EQ(report.at("packs").at("received"), 3);
  for (const char* key : {"lost", "rejected", "duplicate", "reordered"}) EXPECT_EQ(report.at("packs").at(key), 0);
  for (const char* key : {"watched", "suspected", "where", "log_evidence", "log_threshold", "share_of_excess_error",
                          "since_pack", "alarm_pack", "blocks", "window"})
    EXPECT_TRUE(report.at("gap").contains(key)) << key;
  EXPECT_TRUE(report.at("witness_ms").at("p999").is_number());
  EXPECT_EQ(report.at("rt").at("mode"), "best_effort");
  EXPECT_EQ(report.at("rt").at("mlockall"), false);
  EXPECT_TRUE(report.at("rt").at("degraded").is_array());
  EXPECT_EQ(report.at("draws").at("median"), 1000.0);
  EXPECT_EQ(report.at("draws").at("truncated_steps"), 0);
  EXPECT_EQ(report.at("ess").at("min"), 500.0);
  EXPECT_EQ(report.at("parameters").at(0).at("parameters").at("K").at("ar_map"), 3.0);
}

TEST(WriteReport, NamesAFileThatCannotBeWritten) {
  ARMCMC_REQUIRE_MULTICAST();
  const armcmc::test::TestBus bus;
  RtSettings settings;
  settings.lcm_url = bus.url();
  test::FakeEngine engine;
  const Pipeline pipeline(settings, &engine, {});
  try {
    WriteReport(pipeline, pipeline.lane(), "/nonexistent/report.json");
    ADD_FAILURE() << "written";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nonexistent/report.json"), std::string::npos);
  }
}

}  // namespace
}  // namespace armcmc::rt::pipeline_test
