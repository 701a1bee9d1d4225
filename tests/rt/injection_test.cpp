#include "armcmc/rt/injection.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "armcmc/rt/disturbed_engine.hpp"
#include "armcmc/rt/warm_up.hpp"
#include "fake_engine.hpp"
#include "plants/hunt_crossley/model.hpp"

namespace armcmc::rt::injection_test {
namespace {

TEST(ParseInjections, ReadsEveryKind) {
  const auto plan = ParseInjections(
      "overrun_collect@1:5,overrun_adjust@2:6,overrun_execute@3:7,hang_collect@4:8,hang_adjust@5:9,hang_execute@6:10,"
      "squeeze@7,collapse@8,publish@9:3");
  ASSERT_EQ(plan.size(), kNumInjectionKinds);
  for (std::size_t i = 0; i < plan.size(); ++i) {
    EXPECT_EQ(plan[i].kind, static_cast<InjectionKind>(i));
    EXPECT_EQ(plan[i].pack, static_cast<std::int64_t>(i) + 1);
  }
  EXPECT_EQ(plan[5].amount, 10);
  EXPECT_EQ(plan[6].amount, 0);
}

TEST(ParseInjections, RejectsWhatItDoesNotUnderstand) {
  for (const char* list : {"squeeze", "squeeze@", "squeeze@0", "squeeze@1:5", "hang_adjust@1", "hang_adjust@1:0",
                           "hang_adjust@1:60001", "publish@1:1001", "explode@1", "squeeze@1,", "squeeze@1,,squeeze@2"})
    EXPECT_THROW((void)ParseInjections(list), std::invalid_argument) << list;
  EXPECT_TRUE(ParseInjections("").empty());
}

TEST(Injection, FailsSoManyPublicationsFromItsPackOn) {
  Injection injection(ParseInjections("publish@4:2"));
  EXPECT_FALSE(injection.FailsPublication(3));
  EXPECT_TRUE(injection.FailsPublication(4));
  EXPECT_TRUE(injection.FailsPublication(4));
  EXPECT_FALSE(injection.FailsPublication(4));
  EXPECT_FALSE(injection.FailsPublication(5));
  EXPECT_EQ(injection.count(InjectionKind::kPublish), 1);
}

TEST(Injection, TellsWhatItDoes) {
  EventLog events;
  Injection injection(ParseInjections("hang_execute@4:1"));
  injection.SetEventLogs({nullptr, nullptr, &events, nullptr});
  injection.Disturb(Stage::kExecute, 3);
  injection.Disturb(Stage::kAdjust, 4);
  EXPECT_EQ(injection.count(InjectionKind::kHangExecute), 0);
  injection.Disturb(Stage::kExecute, 4);
  EXPECT_EQ(injection.count(InjectionKind::kHangExecute), 1);
  Event event;
  ASSERT_TRUE(events.Take(&event));
  EXPECT_EQ(event.kind, EventKind::kInjected);
  EXPECT_EQ(event.a, 4);
}

TEST(DisturbedEngine, SqueezesTheTimeOfOnePackOnly) {
  test::FakeEngine engine;
  Injection injection(ParseInjections("squeeze@2"));
  DisturbedEngine disturbed(&engine, &injection);
  DataPack pack;
  pack.num_samples = 1;
  for (std::int64_t seq = 1; seq <= 2; ++seq) {
    pack.seq = seq;
    (void)disturbed.Adjust(pack, MonotonicNow() + kNanosPerSecond, MonotonicClock(), 0);
    EXPECT_EQ(engine.last_budget_ns.load() > 0, seq == 1);
  }
}

TEST(DisturbedEngine, TellsAWrongPlantAgainAndAgainToCollapseThePosterior) {
  test::FakeEngine engine;
  Injection injection(ParseInjections("collapse@2"));
  DisturbedEngine disturbed(&engine, &injection);
  DataPack pack;
  pack.seq = 2;
  pack.num_samples = 1;
  (void)disturbed.Adjust(pack, MonotonicNow() + kNanosPerSecond, MonotonicClock(), 0);
  EXPECT_GT(engine.adjusted.load(), 4);
  Estimate estimate;
  disturbed.Execute(0, &estimate);
  const DataPack right = SyntheticPack({HuntCrossley::kInfo.plant, 2}, 7);
  EXPECT_DOUBLE_EQ(estimate.y_pred, 0.5 * right.y[static_cast<std::size_t>(right.num_samples - 1)]);
}

}  // namespace
}  // namespace armcmc::rt::injection_test
