#include "armcmc/rt/deadline_monitor.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace armcmc::rt {
namespace {

constexpr Nanos kMs = 1'000'000;

TEST(Attribute, BlamesNobodyWhenTheDeadlineWasMet) {
  EXPECT_EQ(Attribute({0, 50 * kMs, 50 * kMs}), MissCause::kNone);
  EXPECT_EQ(Attribute({-1, 0, 0}), MissCause::kNone);
}

TEST(Attribute, BlamesTheDataOnlyWhenTheyWereLateByWhatTheStepLacked) {
  EXPECT_EQ(Attribute({10, 10, 0}), MissCause::kLateData);
  EXPECT_EQ(Attribute({10, 9, 0}), MissCause::kOwn);
}

TEST(Attribute, BlamesTheMachineOnlyForStallsAsLongAsWhatTheStepLacked) {
  EXPECT_EQ(Attribute({10, 0, 10}), MissCause::kMachine);
  EXPECT_EQ(Attribute({10, 0, 9}), MissCause::kOwn);
}

TEST(Attribute, IsOurOwnWhenOnlyTheSumWouldExplainIt) { EXPECT_EQ(Attribute({10, 6, 6}), MissCause::kOwn); }

class DeadlineMonitorTest : public ::testing::Test {
 protected:
  DeadlineMonitorTest() {
    for (const Stage stage : {Stage::kCollect, Stage::kExecute}) monitor_->SetWitness(stage, cpu0_.get());
    monitor_->SetWitness(Stage::kAdjust, cpu1_.get());
  }

  /// A step released at 1 s whose adjust ends after adjust_ms; execute takes 1 ms more.
  static StepTimes Step(Nanos adjust_ms, Nanos lateness_ms = 0) {
    StepTimes t;
    t.release_ns = 1000 * kMs;
    t.lateness_ns = lateness_ms * kMs;
    t.arrival_ns = t.release_ns + t.lateness_ns;
    t.deadline_ns = t.release_ns + 100 * kMs;
    t.start_ns[0] = t.arrival_ns;
    t.end_ns[0] = t.start_ns[1] = t.arrival_ns + kMs / 100;
    t.end_ns[1] = t.start_ns[2] = t.arrival_ns + adjust_ms * kMs;
    t.end_ns[2] = t.end_ns[1] + kMs;
    return t;
  }

  /// Wake-ups every 1 ms around the step; the one due at stall_at_ms comes stall_ms late.
  static void Fill(WakeUpRing* ring, Nanos stall_at_ms, Nanos stall_ms) {
    for (Nanos due = 990 * kMs; due < 1300 * kMs;) {
      const Nanos delay = due == stall_at_ms * kMs ? stall_ms * kMs : kMs / 50;
      const Nanos next = due + kMs + (delay / kMs) * kMs;
      ring->Record(due, due + delay, next);
      due = next;
    }
  }

  std::unique_ptr<WakeUpRing> cpu0_ = std::make_unique<WakeUpRing>(), cpu1_ = std::make_unique<WakeUpRing>();
  std::unique_ptr<DeadlineMonitor> monitor_ = std::make_unique<DeadlineMonitor>(RtSettings{});
};

TEST_F(DeadlineMonitorTest, CountsNothingWhenTheDeadlineIsMet) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 0, 0);
  EXPECT_EQ(monitor_->Record(Step(50)), MissCause::kNone);
  EXPECT_EQ(monitor_->misses(MissCause::kOwn), 0);
  EXPECT_EQ(monitor_->stage_times(Stage::kAdjust).count(), 1U);
  EXPECT_NEAR(monitor_->end_to_end().max(), 51e6, 1e5);
}

TEST_F(DeadlineMonitorTest, AnOwnOverrunIsOurOwnAlsoWhenTheWitnessWasALittleLate) {
  Fill(cpu0_.get(), 1050, 5);
  Fill(cpu1_.get(), 1040, 19);
  EXPECT_EQ(monitor_->Record(Step(119)), MissCause::kOwn);  // lacked 20 ms, the machine explains 19
  EXPECT_EQ(monitor_->misses(MissCause::kOwn), 1);
  EXPECT_EQ(monitor_->stage_overruns(Stage::kAdjust), 1);
}

TEST_F(DeadlineMonitorTest, AStallOfTheAdjustCpuIsTheMachine) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 1040, 25);
  EXPECT_EQ(monitor_->Record(Step(119)), MissCause::kMachine);
  EXPECT_EQ(monitor_->misses(MissCause::kMachine), 1);
}

TEST_F(DeadlineMonitorTest, ManyShortStallsAreTheMachineToo) {
  Fill(cpu0_.get(), 0, 0);
  for (Nanos due = 1000 * kMs; due < 1300 * kMs; due += 3 * kMs) {
    cpu1_->Record(due, due + (due < 1080 * kMs ? kMs : kMs / 50), due + 3 * kMs);
  }
  EXPECT_EQ(monitor_->Record(Step(119)), MissCause::kMachine) << "20 ms lacked, 27 stalls of 1 ms";
  EXPECT_EQ(monitor_->Record(Step(129)), MissCause::kOwn) << "30 ms lacked";
}

TEST_F(DeadlineMonitorTest, AStallOfTheOtherCpuIsNoExcuse) {
  Fill(cpu0_.get(), 1040, 60);  // while adjust runs on CPU 1
  Fill(cpu1_.get(), 0, 0);
  EXPECT_EQ(monitor_->Record(Step(119)), MissCause::kOwn);
}

TEST_F(DeadlineMonitorTest, AStallOutsideTheStepIsNoExcuse) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 1150, 80);
  EXPECT_EQ(monitor_->Record(Step(119)), MissCause::kOwn);
}

TEST_F(DeadlineMonitorTest, ALatePackIsLateData) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 0, 0);
  EXPECT_EQ(monitor_->Record(Step(5, /*lateness_ms=*/97)), MissCause::kLateData);
  EXPECT_EQ(monitor_->Record(Step(119, /*lateness_ms=*/2)), MissCause::kOwn) << "two milliseconds late, 22 lacked";
}

TEST_F(DeadlineMonitorTest, WithoutAWitnessTheMachineIsNeverBlamed) {
  DeadlineMonitor alone{RtSettings{}};
  EXPECT_EQ(alone.Record(Step(119)), MissCause::kOwn);
}

TEST_F(DeadlineMonitorTest, ADroppedPackIsAMissWithACause) {
  Fill(cpu0_.get(), 0, 0);
  Fill(cpu1_.get(), 1010, 150);
  const StepTimes times = Step(0);
  EXPECT_EQ(monitor_->RecordDropped(times, Stage::kAdjust, 1161 * kMs, 61 * kMs), MissCause::kMachine);
  EXPECT_EQ(monitor_->RecordDropped(times, Stage::kAdjust, 1005 * kMs, 1 * kMs), MissCause::kOwn);
  EXPECT_EQ(monitor_->misses(MissCause::kMachine), 1);
  EXPECT_EQ(monitor_->misses(MissCause::kOwn), 1);
}

}  // namespace
}  // namespace armcmc::rt
