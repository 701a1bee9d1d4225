#include "armcmc/rt/deadline_monitor.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace armcmc::rt::deadline_monitor_test {
namespace {

constexpr Nanos kMs = 1'000'000;

class DeadlineMonitorTest : public ::testing::Test {
 protected:
  DeadlineMonitorTest() { StartAnew(); }

  /// A monitor that knows nothing of the steps so far.
  void StartAnew() {
    monitor_ = std::make_unique<DeadlineMonitor>(RtSettings{});
    for (const Stage stage : {Stage::kCollect, Stage::kExecute}) monitor_->SetWitness(stage, cpu0_.get());
    monitor_->SetWitness(Stage::kAdjust, cpu1_.get());
  }

  /// A step that adjust comes to at start_ms and is through with at end_ms; execute takes 1 ms more.
  static StepTimes Step(Nanos release_ms, Nanos lateness_ms, Nanos start_ms, Nanos end_ms) {
    StepTimes t = Step(0, lateness_ms, release_ms);
    t.start_ns[1] = start_ms * kMs;
    t.end_ns[1] = t.start_ns[2] = end_ms * kMs;
    t.end_ns[2] = t.end_ns[1] + kMs;
    return t;
  }

  /// A step released at release_ms whose adjust ends after adjust_ms; execute takes 1 ms more.
  static StepTimes Step(Nanos adjust_ms, Nanos lateness_ms = 0, Nanos release_ms = 1000) {
    StepTimes t;
    t.release_ns = release_ms * kMs;
    t.lateness_ns = lateness_ms * kMs;
    t.arrival_ns = t.release_ns + t.lateness_ns;
    t.deadline_ns = t.release_ns + 100 * kMs;
    t.start_ns[0] = t.arrival_ns;
    t.end_ns[0] = t.start_ns[1] = t.arrival_ns + kMs / 100;
    t.end_ns[1] = t.start_ns[2] = t.arrival_ns + adjust_ms * kMs;
    t.end_ns[2] = t.end_ns[1] + kMs;
    return t;
  }

  /// The step goes through all stages.
  MissCause Judge(StepTimes times) {
    monitor_->RecordAdjusted(&times);
    return monitor_->Record(times);
  }

  std::vector<MissCause> JudgeBacklog() {
    return {Judge(Step(1000, 0, 1000, 1210)), Judge(Step(1100, 0, 1210, 1270)), Judge(Step(1200, 0, 1270, 1330))};
  }

  /// Wake-ups every 1 ms around the step; the one due at stall_at_ms comes stall_ms late.
  static void Fill(WakeUpRing* ring, Nanos stall_at_ms, Nanos stall_ms) {
    for (Nanos due = 990 * kMs; due < 2000 * kMs;) {
      const Nanos delay = due == stall_at_ms * kMs ? stall_ms * kMs : kMs / 50;
      const Nanos next = due + kMs + (delay / kMs) * kMs;
      ring->Record(due, due + delay, next);
      due = next;
    }
  }

  std::unique_ptr<WakeUpRing> cpu0_ = std::make_unique<WakeUpRing>(), cpu1_ = std::make_unique<WakeUpRing>();
  std::unique_ptr<DeadlineMonitor> monitor_;
};

TEST_F(DeadlineMonitorTest, AStageWaitsFromTheEndOfTheOneBefore) {
  StepTimes t = Step(50);
  t.start_ns[0] = t.arrival_ns + 1 * kMs;
  t.end_ns[0] = t.start_ns[0] + 4 * kMs;
  t.start_ns[1] = t.end_ns[0] + 2 * kMs;
  t.start_ns[2] = t.end_ns[1] + 8 * kMs;
  t.end_ns[2] = t.start_ns[2] + 16 * kMs;
  (void)Judge(t);
  EXPECT_EQ(monitor_->waiting_times(Stage::kCollect).max(), 1 * kMs);
  EXPECT_EQ(monitor_->waiting_times(Stage::kAdjust).max(), 2 * kMs);
  EXPECT_EQ(monitor_->waiting_times(Stage::kExecute).max(), 8 * kMs);
}

TEST_F(DeadlineMonitorTest, CountsNothingWhenTheDeadlineIsMet) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 0, 0);
  EXPECT_EQ(Judge(Step(50)), MissCause::kNone);
  EXPECT_EQ(monitor_->misses(MissCause::kOwn), 0);
  EXPECT_EQ(monitor_->stage_times(Stage::kAdjust).count(), 1U);
  EXPECT_NEAR(monitor_->end_to_end().max(), 51e6, 1e5);
}

TEST_F(DeadlineMonitorTest, AnOwnOverrunIsOurOwnAlsoWhenTheWitnessWasALittleLate) {
  Fill(cpu0_.get(), 1050, 5);
  Fill(cpu1_.get(), 1040, 19);
  EXPECT_EQ(Judge(Step(119)), MissCause::kOwn);  // lacked 20 ms, the machine explains 19
  EXPECT_EQ(monitor_->misses(MissCause::kOwn), 1);
  EXPECT_EQ(monitor_->stage_overruns(Stage::kAdjust), 1);
}

TEST_F(DeadlineMonitorTest, AStallOfTheAdjustCpuIsTheMachine) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 1040, 25);
  EXPECT_EQ(Judge(Step(119)), MissCause::kMachine);
  EXPECT_EQ(monitor_->misses(MissCause::kMachine), 1);
}

TEST_F(DeadlineMonitorTest, ManyShortStallsAreTheMachineToo) {
  Fill(cpu0_.get(), 0, 0);
  for (Nanos due = 1000 * kMs; due < 1300 * kMs; due += 3 * kMs) {
    cpu1_->Record(due, due + (due < 1080 * kMs ? kMs : kMs / 50), due + 3 * kMs);
  }
  EXPECT_EQ(Judge(Step(119)), MissCause::kMachine) << "20 ms lacked, 27 stalls of 1 ms";
  StartAnew();
  EXPECT_EQ(Judge(Step(129)), MissCause::kOwn) << "30 ms lacked";
}

TEST_F(DeadlineMonitorTest, WhatWasWithheldFromAStageIsTheMachineAlsoWhereTheWitnessSawLess) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 1040, 15);
  StepTimes times = Step(119);  // lacks 20 ms
  times.withheld_ns[1] = 19 * kMs;
  EXPECT_EQ(Judge(times), MissCause::kOwn) << "15 and 19 ms are two views of one stall";
  StartAnew();
  times.withheld_ns[1] = 21 * kMs;
  EXPECT_EQ(Judge(times), MissCause::kMachine);
  EXPECT_EQ(Judge(Step(1100, 0, 1120, 1190)), MissCause::kNone);
  StartAnew();
  times.withheld_ns = {0, 15 * kMs, 6 * kMs};
  EXPECT_EQ(Judge(times), MissCause::kMachine) << "half of it in execute";
}

TEST_F(DeadlineMonitorTest, WhatWasWithheldFromAStageThatWaitedIsTheMachine) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 0, 0);
  StepTimes times = Step(1000, 0, 1030, 1119);  // adjust woken 30 ms late; lacks 20 ms
  times.withheld_before_ns[1] = 29 * kMs;
  EXPECT_EQ(Judge(times), MissCause::kMachine);
  StartAnew();
  times.withheld_before_ns[1] = 19 * kMs;
  EXPECT_EQ(Judge(times), MissCause::kOwn);
  StartAnew();
  times = Step(1000, 0, 1005, 1119);
  times.withheld_before_ns[1] = 29 * kMs;
  EXPECT_EQ(Judge(times), MissCause::kOwn) << "no longer than it waited";
  StartAnew();
  StepTimes dropped = Step(100);
  EXPECT_EQ(monitor_->RecordDropped(dropped, 1040 * kMs, 65 * kMs, 30 * kMs), MissCause::kMachine);
  StartAnew();
  EXPECT_EQ(monitor_->RecordDropped(dropped, 1040 * kMs, 65 * kMs, 3 * kMs), MissCause::kOwn);
}

TEST_F(DeadlineMonitorTest, AStallOfTheOtherCpuIsNoExcuse) {
  Fill(cpu0_.get(), 1040, 60);  // while adjust runs on CPU 1
  Fill(cpu1_.get(), 0, 0);
  EXPECT_EQ(Judge(Step(119)), MissCause::kOwn);
}

TEST_F(DeadlineMonitorTest, AStallOutsideTheStepIsNoExcuse) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 1150, 80);
  EXPECT_EQ(Judge(Step(119)), MissCause::kOwn);
}

TEST_F(DeadlineMonitorTest, ALatePackIsLateData) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 0, 0);
  EXPECT_EQ(Judge(Step(5, /*lateness_ms=*/97)), MissCause::kLateData);
  StartAnew();
  EXPECT_EQ(Judge(Step(119, /*lateness_ms=*/2)), MissCause::kOwn) << "two milliseconds late, 22 lacked";
}

TEST_F(DeadlineMonitorTest, WithoutAWitnessTheMachineIsNeverBlamed) {
  DeadlineMonitor alone{RtSettings{}};
  EXPECT_EQ(alone.Record(Step(119)), MissCause::kOwn);
}

// A backlog of steps of 60 ms each behind one that took 210 ms.
TEST_F(DeadlineMonitorTest, StepsThatWaitBehindAStalledOneAreTheMachineToo) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 1010, 150);
  EXPECT_EQ(JudgeBacklog(), std::vector(3, MissCause::kMachine)) << "the third has no stall in its own time";
  EXPECT_EQ(Judge(Step(1300, 0, 1330, 1390)), MissCause::kNone);
  EXPECT_EQ(Judge(Step(1400, 0, 1400, 1540)), MissCause::kOwn) << "caught up: nothing is owed any more";
}

TEST_F(DeadlineMonitorTest, StepsThatWaitBehindAnOwnOverrunAreOurOwn) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 1110, 20);
  EXPECT_EQ(JudgeBacklog(), std::vector(3, MissCause::kOwn)) << "20 of 111 ms were the machine";
}

TEST_F(DeadlineMonitorTest, AStallAfterTheHandOverDelaysTheNextStep) {
  // The second pack comes at 1100; adjust is busy with what follows the first until 1130, and needs 80 ms for it.
  const auto judge_second = [&](Nanos busy_until_ms, Nanos withheld_ms) {
    StartAnew();
    StepTimes first = Step(1000, 0, 1000, 1090);
    EXPECT_EQ(Judge(first), MissCause::kNone);
    monitor_->RecordRemembered(first, busy_until_ms * kMs, withheld_ms * kMs);
    return Judge(Step(1100, 0, busy_until_ms, busy_until_ms + 80));
  };
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 0, 0);
  EXPECT_EQ(judge_second(1130, 0), MissCause::kOwn) << "its own doing";
  EXPECT_EQ(judge_second(1130, 5), MissCause::kOwn) << "lacks 11 ms";
  EXPECT_EQ(judge_second(1130, 30), MissCause::kMachine);
  Fill(cpu1_.get(), 1095, 30);
  EXPECT_EQ(judge_second(1130, 0), MissCause::kMachine) << "the witness saw it, too";
}

TEST_F(DeadlineMonitorTest, StepsThatWaitBehindALatePackAreLateData) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 0, 0);
  EXPECT_EQ(Judge(Step(1000, 150, 1151, 1211)), MissCause::kLateData);
  EXPECT_EQ(Judge(Step(1100, 50, 1211, 1271)), MissCause::kLateData) << "71 ms lacked, 50 ms late itself";
  EXPECT_EQ(Judge(Step(1200, 0, 1271, 1331)), MissCause::kLateData) << "31 ms lacked, itself on time";
}

TEST_F(DeadlineMonitorTest, LatenessAndStallsTogetherBlameTheLongerOne) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 1060, 15);
  EXPECT_EQ(Judge(Step(1000, 10, 1010, 1119)), MissCause::kMachine) << "20 ms lacked, 10 late, 15 stalled";
  StartAnew();
  EXPECT_EQ(Judge(Step(1000, 18, 1018, 1119)), MissCause::kLateData);
  StartAnew();
  EXPECT_EQ(Judge(Step(1000, 4, 1004, 1119)), MissCause::kOwn) << "19 of 20 ms explained";
}

// The whole machine stood still: the plant's packs came late, and adjust was behind when they came.
TEST_F(DeadlineMonitorTest, LatePacksBehindAStalledStepAreNotOurOwn) {
  Fill(cpu0_.get(), 1010, 250);
  Fill(cpu1_.get(), 1010, 250);
  EXPECT_EQ(Judge(Step(1000, 0, 1000, 1270)), MissCause::kMachine);
  EXPECT_EQ(Judge(Step(1100, 170, 1270, 1290)), MissCause::kLateData) << "on time it had waited for the step before it";
  EXPECT_EQ(Judge(Step(1200, 70, 1290, 1310)), MissCause::kLateData);
  EXPECT_EQ(Judge(Step(1300, 0, 1310, 1395)), MissCause::kNone);
  EXPECT_EQ(Judge(Step(1400, 0, 1400, 1505)), MissCause::kOwn);
}

// Collect, on CPU 0, wakes adjust, on CPU 1.
TEST_F(DeadlineMonitorTest, AStallOfTheCpuThatHandsOverDelaysTheStageThatSleeps) {
  Fill(cpu0_.get(), 1000, 60);
  Fill(cpu1_.get(), 0, 0);
  EXPECT_EQ(Judge(Step(1000, 0, 1060, 1119)), MissCause::kMachine) << "collect was through, but could not say so";
  StartAnew();
  Fill(cpu0_.get(), 0, 0);
  EXPECT_EQ(Judge(Step(1000, 0, 1060, 1119)), MissCause::kOwn) << "nobody saw a stall";
  StartAnew();
  Fill(cpu0_.get(), 1000, 60);
  EXPECT_EQ(Judge(Step(900, 0, 900, 1060)), MissCause::kOwn);
  EXPECT_EQ(Judge(Step(1000, 0, 1060, 1119)), MissCause::kOwn) << "adjust was at work and did not sleep";
}

TEST_F(DeadlineMonitorTest, AnOvertakenResultBlamesWhatHeldExecuteUp) {
  Fill(cpu0_.get(), 1060, 60);
  Fill(cpu1_.get(), 0, 0);
  StepTimes times = Step(1000, 0, 1000, 1050);
  monitor_->RecordAdjusted(&times);
  EXPECT_EQ(monitor_->RecordOvertaken(times, 1110 * kMs, 10 * kMs), MissCause::kMachine);
  EXPECT_EQ(monitor_->RecordOvertaken(times, 1110 * kMs, 60 * kMs), MissCause::kOwn);
}

TEST_F(DeadlineMonitorTest, ADroppedPackIsAMissWithACause) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 1010, 150);
  EXPECT_EQ(Judge(Step(1000, 0, 1000, 1210)), MissCause::kMachine);
  EXPECT_EQ(monitor_->RecordDropped(Step(0, 0, 1100), 1210 * kMs, 60 * kMs), MissCause::kMachine);
  EXPECT_EQ(monitor_->misses(MissCause::kMachine), 2);
  StartAnew();
  EXPECT_EQ(monitor_->RecordDropped(Step(0), 1005 * kMs, 96 * kMs), MissCause::kOwn);
  EXPECT_EQ(monitor_->misses(MissCause::kOwn), 1);
}

TEST_F(DeadlineMonitorTest, ADroppedPackWouldHaveTakenItsTime) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 1010, 150);
  EXPECT_EQ(Judge(Step(1000, 0, 1000, 1230)), MissCause::kMachine);
  // Without the stall the first had been through at 1080, this one at 1180, and the next at 1280.
  EXPECT_EQ(monitor_->RecordDropped(Step(0, 0, 1100), 1230 * kMs, 80 * kMs), MissCause::kMachine);
  EXPECT_EQ(Judge(Step(1200, 0, 1230, 1330)), MissCause::kOwn) << "130 ms, 30 of them waited; 50 would have been free";
}

}  // namespace
}  // namespace armcmc::rt::deadline_monitor_test
