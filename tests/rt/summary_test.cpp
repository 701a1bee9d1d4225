#include "summary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>

#include "armcmc/rt/clock.hpp"
#include "fake_engine.hpp"
#include "support/paths.hpp"
#include "test_bus.hpp"
#include "test_packs.hpp"

namespace armcmc::rt::summary_test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// An engine with three parameters that has learnt something, and a gap watch.
class LearntEngine final : public test::FakeEngine {
 public:
  void Execute(int slot, Estimate* estimate) noexcept ARMCMC_NONBLOCKING override {
    FakeEngine::Execute(slot, estimate);
    ModeEstimate& mode = estimate->modes[0];
    mode.known = learnt;
    mode.marginal[0].ar_map = 4.0;
    mode.marginal[0].sd = 0.125;
    mode.marginal[1].ar_map = 2.25;
    mode.marginal[1].sd = 0.0625;
    mode.marginal[2].ar_map = 1.75;
    mode.marginal[2].sd = 0.03125;
    estimate->gap = gap;
  }
  bool learnt = true;  ///< Set, as the gap is, before the pipeline starts.
  GapState gap;
};

class SummaryTest : public ::testing::Test {
 protected:
  void SetUp() override { ARMCMC_REQUIRE_MULTICAST(); }

  /// What is said at the end of a run of so many packs.
  std::string AfterPacks(std::int64_t packs, const std::string& gap_window = "") {
    RtSettings settings;
    settings.lcm_url = bus_.url();
    settings.lock_memory = false;
    settings.period_ns = 50 * kNanosPerMilli;
    settings.deadline_ns = 500 * kNanosPerMilli;
    settings.adjust_budget_ns = 20 * kNanosPerMilli;
    test::Peer peer(bus_.url());
    Pipeline pipeline(settings, &engine_, PipelineOptions{});
    pipeline.Start();
    const auto steps = [&] { return pipeline.lane().counters().execute.steps.Get(); };
    // Collect begins to listen some time after Start(): the first pack is sent until it is heard; duplicates are
    // dropped.
    for (std::int64_t seq = 1; seq <= packs; ++seq) {
      for (const Nanos end = MonotonicNow() + test::kLong; steps() < seq && MonotonicNow() < end;
           SleepUntil(MonotonicNow() + 5 * kNanosPerMilli))
        peer.Publish("PLANT_PACK", test::Encode(test::ValidPack(seq)));
      EXPECT_EQ(steps(), seq);
    }
    pipeline.RequestStop();
    pipeline.Join();
    const Estimator estimator(BuiltinSettings("hunt_crossley"));
    return app::SummaryText(pipeline, pipeline.lane(), estimator, gap_window);
  }

  armcmc::test::TestBus bus_;
  LearntEngine engine_;
};

TEST_F(SummaryTest, HasCountsTimesAndParameters) {
  const std::string text = AfterPacks(3);
  EXPECT_THAT(text, HasSubstr("steps 3, deadline 500 ms, missed: own "));
  EXPECT_THAT(text, HasSubstr(", lost 0, rejected 0, duplicate "));
  EXPECT_THAT(text, HasSubstr("draws per posterior: median 1000, minimum 1000; effective: median 500\n"));
  EXPECT_THAT(text, HasSubstr("degraded: "));
  EXPECT_THAT(text, HasSubstr("no_mlock"));
  EXPECT_THAT(text, HasSubstr("time, ms"));
  for (const char* row :
       {"collect  ", "adjust  ", "execute  ", "release to estimate ", "arrival to published ", "wake-up latency "})
    EXPECT_THAT(text, HasSubstr(row));
  EXPECT_THAT(text, testing::ContainsRegex("K +4 +0.125 +N/m"));
  EXPECT_THAT(text, testing::ContainsRegex("B +2.25 +0.0625 +N"));
  EXPECT_THAT(text, testing::ContainsRegex("p +1.75 +0.0312 "));
  EXPECT_THAT(text, Not(HasSubstr("gap between model and plant"))) << "it is not watched";
}

TEST_F(SummaryTest, SaysThatNothingWasLearnt) {
  engine_.learnt = false;
  EXPECT_THAT(AfterPacks(1), HasSubstr("no parameter was estimated: no pack with information was received\n"));
}

TEST_F(SummaryTest, OfARunWithoutPacksHasNoTimes) {
  const std::string text = AfterPacks(0);
  EXPECT_THAT(text, HasSubstr("steps 0, "));
  EXPECT_THAT(text, Not(HasSubstr("time, ms")));
  EXPECT_THAT(text, Not(HasSubstr("draws per posterior")));
}

TEST_F(SummaryTest, SaysThatTooFewPacksWereJudged) {
  engine_.gap.watched = true;
  EXPECT_THAT(AfterPacks(1), HasSubstr("gap between model and plant: not judged, since too few packs were usable\n"));
}

TEST_F(SummaryTest, SaysThatNoGapIsSuspected) {
  engine_.gap.watched = true;
  engine_.gap.num_blocks = 7;
  engine_.gap.log_evidence = -1.25;
  engine_.gap.log_threshold = 4.5;
  EXPECT_THAT(AfterPacks(1, "window.csv"),
              HasSubstr("gap between model and plant: none suspected (log evidence -1.25, threshold 4.5)\n"));
}

TEST_F(SummaryTest, NamesTheProgramThatFindsWhatIsMissing) {
  engine_.gap.watched = engine_.gap.suspected = true;
  engine_.gap.num_blocks = 7;
  engine_.gap.since_seq = 42;
  engine_.gap.where = "the sign of the velocity";
  engine_.gap.log_evidence = 9.5;
  engine_.gap.log_threshold = 4.5;
  const std::string text = AfterPacks(1, "window.csv");
  EXPECT_THAT(text, HasSubstr("GAP SUSPECTED since pack 42: the model is missing something, seen in the sign of the "
                              "velocity (log evidence 9.5, threshold 4.5)\n"));
  EXPECT_THAT(text,
              HasSubstr("data: window.csv; to find what is missing: armcmc-gap --model hunt_crossley --data window.csv "
                        "--out FOLDER\n"));
}

}  // namespace
}  // namespace armcmc::rt::summary_test
