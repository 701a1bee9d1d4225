#include "armcmc/stress/fault_judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace armcmc::stress::fault_judge_test {
namespace {

constexpr std::int64_t kT = 100'000'000;
constexpr std::int64_t kFirst = 20;  // begin of the slot; the fault is at kFirst + 3

/// A run of the estimator, told step by step.
class FaultJudgeTest : public ::testing::Test {
 protected:
  FaultJudgeTest() {
    estimate_.run_id = 7;
    estimate_.known = 1;
    for (int i = 0; i < 3; ++i) {
      estimate_.ar_map[i] = 4.0;
      estimate_.q025[i] = 3.9;
      estimate_.q975[i] = 4.1;
      estimate_.sd[i] = 0.05;
    }
  }

  /// Quiet until this pack.
  void Begin(const std::string& fault, std::int64_t packs = 10,
             std::int64_t quiet_until = kFirst + Slot::kQuietBefore - 1) {
    judge_.BeginRun({{SelectFaults(fault).front(), kFirst, kFirst + packs}});
    for (std::int64_t seq = 1; seq <= quiet_until; ++seq) Step(seq);
  }
  /// One pack with its estimate and its status.
  void Step(std::int64_t seq, std::int32_t flags = 0, std::int32_t miss = estimator_status_t::MISS_NONE) {
    estimate_.seq = seq;
    estimate_.t_release_ns = seq * kT;
    judge_.OnEstimate(estimate_);
    Status(seq, flags, miss);
  }
  void Status(std::int64_t seq, std::int32_t flags = 0, std::int32_t miss = estimator_status_t::MISS_NONE) {
    status_.last_seq = seq;
    ++status_.step;
    status_.t_status_ns = std::max(status_.t_status_ns + 1, seq * kT + kT / 2);
    status_.fault_flags = flags;
    status_.miss_cause = miss;
    judge_.OnStatus(status_);
  }
  FaultOutcome Outcome() {
    const auto outcomes = judge_.TakeOutcomes();
    EXPECT_EQ(outcomes.size(), 1U);
    return outcomes.empty() ? FaultOutcome{} : outcomes.front();
  }

  FaultJudge judge_{kT};
  estimate_t estimate_{};
  estimator_status_t status_{};
};

TEST_F(FaultJudgeTest, AFaultThatIsCountedAndFlaggedAndOverAtOnce) {
  Begin("nan");
  ++status_.rejected_value;
  ++status_.packs_rejected;
  Step(24, estimator_status_t::FAULT_BAD_DATA);  // pack 23 was rejected
  for (std::int64_t seq = 25; seq <= 30; ++seq) Step(seq);
  const FaultOutcome outcome = Outcome();
  EXPECT_TRUE(outcome.injected);
  EXPECT_TRUE(outcome.detected);
  EXPECT_EQ(outcome.flags, estimator_status_t::FAULT_BAD_DATA);
  EXPECT_EQ(outcome.recovered_steps, 2) << "the step that told of it, and a normal one";
}

// The estimator was behind: pack 23 had come and was rejected when step 21 was through.
TEST_F(FaultJudgeTest, AFaultThatIsToldByAnEarlierStepIsDetected) {
  Begin("nan", 10, 20);
  status_.t_status_ns = 23 * kT + kT / 4;
  ++status_.rejected_value;
  Step(21, estimator_status_t::FAULT_BAD_DATA);
  for (std::int64_t seq = 22; seq <= 30; ++seq)
    if (seq != 23) Step(seq);
  EXPECT_TRUE(Outcome().detected);
}

TEST_F(FaultJudgeTest, WhatWasToldBeforeTheFaultCameIsNoDetection) {
  Begin("nan", 10, 20);
  ++status_.rejected_value;
  Step(21, estimator_status_t::FAULT_BAD_DATA);
  for (std::int64_t seq = 22; seq <= 30; ++seq) Step(seq);
  EXPECT_FALSE(Outcome().detected);
}

TEST_F(FaultJudgeTest, AStepThatSaysSoItselfIsDetectedThoughOthersBeforeItSaidTheSame) {
  Begin("overload", 10, 20);
  ++status_.truncated_steps;  // a stall of the machine
  Step(21, estimator_status_t::FAULT_TRUNCATED);
  Step(22);
  ++status_.truncated_steps;
  Step(23, estimator_status_t::FAULT_TRUNCATED);
  for (std::int64_t seq = 24; seq <= 30; ++seq) Step(seq);
  EXPECT_TRUE(Outcome().detected);
}

// The machine had stopped the plant for a moment, too.
TEST_F(FaultJudgeTest, AFlagOfAnEarlierStatusDoesNotHideAFault) {
  Begin("plant_stop", 10, 20);
  Status(20, estimator_status_t::FAULT_PLANT_SILENT);
  for (std::int64_t seq = 21; seq <= 22; ++seq) Step(seq);
  judge_.SignalBegins();
  ++status_.silent_periods;
  Status(22, estimator_status_t::FAULT_PLANT_SILENT);
  judge_.SignalEnds(23);
  for (std::int64_t seq = 23; seq <= 30; ++seq) Step(seq);
  EXPECT_TRUE(Outcome().detected);
}

TEST_F(FaultJudgeTest, AFlagThatIsStillUpIsNoDetection) {
  Begin("plant_stop", 10, 22);
  Status(22, estimator_status_t::FAULT_PLANT_SILENT);
  judge_.SignalBegins();
  ++status_.silent_periods;
  Status(22, estimator_status_t::FAULT_PLANT_SILENT);
  judge_.SignalEnds(23);
  for (std::int64_t seq = 23; seq <= 30; ++seq) Step(seq);
  EXPECT_FALSE(Outcome().detected);
}

TEST_F(FaultJudgeTest, AStepBeforeTheFaultDoesNotSpeakForIt) {
  Begin("overload", 10, 20);
  ++status_.truncated_steps;
  Step(21, estimator_status_t::FAULT_TRUNCATED);
  for (std::int64_t seq = 22; seq <= 30; ++seq) Step(seq);
  EXPECT_FALSE(Outcome().detected);
}

TEST_F(FaultJudgeTest, AFaultThatNobodyNoticedIsNotDetected) {
  Begin("nan");
  for (std::int64_t seq = 23; seq <= 30; ++seq) Step(seq);
  const FaultOutcome outcome = Outcome();
  EXPECT_TRUE(outcome.injected);
  EXPECT_FALSE(outcome.detected);
}

/// The first estimate of three moves by so many joint standard deviations at the fault.
class MovedEstimate : public FaultJudgeTest, public ::testing::WithParamInterface<double> {};

TEST_P(MovedEstimate, MayMoveByTwoJointDeviations) {
  Begin("nan");
  ++status_.rejected_value;
  ++status_.packs_rejected;
  estimate_.ar_map[0] = 4.0 + GetParam() * 0.05 * std::sqrt(2.0);
  for (std::int64_t seq = 24; seq <= 30; ++seq) Step(seq);
  EXPECT_EQ(Outcome().recovered_steps == FaultJudge::kNever, GetParam() > 2.0);
}

INSTANTIATE_TEST_SUITE_P(JointDeviations, MovedEstimate, ::testing::Values(1.9, 2.1));

TEST_F(FaultJudgeTest, AFlagInAStatusThatDidNotComeCannotBeJudged) {
  Begin("nan");
  ++status_.step;  // the status that told of it was lost on its way
  for (std::int64_t seq = 24; seq <= 30; ++seq) Step(seq);
  EXPECT_FALSE(Outcome().injected);
}

TEST_F(FaultJudgeTest, APackThatTheBusLostWasNotAFault) {
  Begin("nan");
  ++status_.packs_lost;
  for (std::int64_t seq = 24; seq <= 30; ++seq) Step(seq);
  EXPECT_FALSE(Outcome().injected);
}

TEST_F(FaultJudgeTest, AnEstimateThatStaysApartHasLostWhatWasLearnt) {
  Begin("nan");
  ++status_.rejected_value;
  estimate_.ar_map[1] = 5.0;
  for (std::int64_t seq = 24; seq <= 30; ++seq) Step(seq, seq == 24 ? estimator_status_t::FAULT_BAD_DATA : 0);
  const FaultOutcome outcome = Outcome();
  EXPECT_EQ(outcome.recovered_steps, FaultJudge::kNever);
  EXPECT_STREQ(outcome.hindrance, "estimate apart");
}

TEST_F(FaultJudgeTest, AnIntervalThatHasGrownHasLostWhatWasLearnt) {
  Begin("nan");
  estimate_.q025[2] = 3.0;
  for (std::int64_t seq = 24; seq <= 30; ++seq) Step(seq);
  EXPECT_EQ(Outcome().recovered_steps, FaultJudge::kNever);
}

TEST_F(FaultJudgeTest, CountsTheStepsThatARecoveryTakes) {
  Begin("overload");
  ++status_.truncated_steps;
  Step(23, estimator_status_t::FAULT_TRUNCATED);
  estimate_.truncated = 1;
  for (std::int64_t seq = 24; seq <= 26; ++seq) Step(seq, estimator_status_t::FAULT_TRUNCATED);
  estimate_.truncated = 0;
  for (std::int64_t seq = 27; seq <= 30; ++seq) Step(seq);
  EXPECT_EQ(Outcome().recovered_steps, 4);
}

TEST_F(FaultJudgeTest, StepsThatTheMachineTookAreNotCounted) {
  Begin("overload");
  ++status_.truncated_steps;
  Step(23, estimator_status_t::FAULT_TRUNCATED);
  for (std::int64_t seq = 24; seq <= 26; ++seq) {
    ++status_.missed_machine;
    Step(seq, 0, estimator_status_t::MISS_MACHINE);
  }
  for (std::int64_t seq = 27; seq <= 30; ++seq) Step(seq);
  const FaultOutcome outcome = Outcome();
  EXPECT_EQ(outcome.recovered_steps, 1);
  EXPECT_EQ(outcome.stalled_steps, 3);
}

TEST_F(FaultJudgeTest, OwnMissesOfTheSlotAreCounted) {
  Begin("overrun_adjust");
  status_.missed_own += 2;
  Step(23, 0, estimator_status_t::MISS_OWN);
  for (std::int64_t seq = 24; seq <= 30; ++seq) Step(seq);
  const FaultOutcome outcome = Outcome();
  EXPECT_TRUE(outcome.detected);
  EXPECT_EQ(outcome.own_misses, 2);
}

TEST_F(FaultJudgeTest, ASignalThatWasNeverSentIsNoFault) {
  Begin("bus_flood");
  for (std::int64_t seq = 23; seq <= 30; ++seq) Step(seq);
  EXPECT_FALSE(Outcome().injected);
}

/// A flood of 40 packs, in which the estimate moves and its interval grows a little with every pack, and a jump.
class FloodedEstimate : public FaultJudgeTest {
 protected:
  std::int64_t RecoveredSteps(double move, double grow, double jump) {
    Begin("bus_flood", 60);
    judge_.SignalBegins();
    for (std::int64_t seq = 23; seq <= 80; ++seq) {
      if (seq < 63) {
        estimate_.ar_map[0] += move * 0.05;
        if (seq == 40) estimate_.ar_map[0] += jump * 0.05;
        estimate_.q025[0] = estimate_.ar_map[0] - 0.1 * std::pow(1.0 + grow, static_cast<double>(seq - 22));
        estimate_.q975[0] = estimate_.ar_map[0] + 0.1 * std::pow(1.0 + grow, static_cast<double>(seq - 22));
      }
      Step(seq, seq < 63 ? estimator_status_t::FAULT_BUS_FLOOD : 0);
      if (seq == 62) judge_.SignalEnds(62);
    }
    const FaultOutcome outcome = Outcome();
    EXPECT_TRUE(outcome.detected);
    return outcome.recovered_steps;
  }
};

TEST_F(FloodedEstimate, MayMoveWithItsData) { EXPECT_EQ(RecoveredSteps(0.2, 0.0, 0.0), 1); }

TEST_F(FloodedEstimate, MayNotJump) { EXPECT_EQ(RecoveredSteps(0.0, 0.0, 3.0), FaultJudge::kNever); }

TEST_F(FloodedEstimate, MayNotForgetLittleByLittle) { EXPECT_EQ(RecoveredSteps(0.0, 0.05, 0.0), FaultJudge::kNever); }

// The backlog of a plant that stood still: five packs in a row are given up, as the last late step already tells.
TEST_F(FaultJudgeTest, PacksGivenUpRightAfterAFaultBelongToIt) {
  Begin("plant_stop", 40);
  judge_.SignalBegins();
  ++status_.silent_periods;
  Status(22, estimator_status_t::FAULT_PLANT_SILENT);
  judge_.SignalEnds(40);
  for (std::int64_t seq = 23; seq < 40; ++seq) Step(seq, 0, estimator_status_t::MISS_LATE_DATA);
  status_.packs_dropped += 5;
  Step(40, estimator_status_t::FAULT_BACKLOG, estimator_status_t::MISS_LATE_DATA);
  for (std::int64_t seq = 46; seq <= 60; ++seq) Step(seq);
  const FaultOutcome outcome = Outcome();
  EXPECT_TRUE(outcome.detected);
  EXPECT_EQ(outcome.stalled_steps, 5);
  EXPECT_EQ(outcome.recovered_steps, 1);
}

TEST_F(FaultJudgeTest, PacksThatNobodyGaveUpAreMissing) {
  Begin("plant_stop", 40);
  judge_.SignalBegins();
  ++status_.silent_periods;
  Status(22, estimator_status_t::FAULT_PLANT_SILENT);
  judge_.SignalEnds(40);
  for (std::int64_t seq = 23; seq <= 40; ++seq) Step(seq, 0, estimator_status_t::MISS_LATE_DATA);
  for (std::int64_t seq = 46; seq <= 60; ++seq) Step(seq);
  EXPECT_EQ(Outcome().recovered_steps, 6);
}

TEST_F(FaultJudgeTest, ANewRunOfThePlantIsJudgedFromItsFirstPackOn) {
  Begin("nan");
  judge_.BeginRun({{SelectFaults("plant_death").front(), 1 - Slot::kQuietBefore, 9}});
  Status(22, estimator_status_t::FAULT_PLANT_SILENT);
  Step(22);  // an old estimate that comes late starts nothing
  EXPECT_FALSE(judge_.run_started());
  ++status_.plant_restarts;
  estimate_.run_id = 8;
  Step(1, estimator_status_t::FAULT_PLANT_RESTARTED);
  for (std::int64_t seq = 2; seq <= 9; ++seq) Step(seq);
  const FaultOutcome outcome = Outcome();
  EXPECT_TRUE(outcome.detected);
  EXPECT_EQ(outcome.recovered_steps, 2);
}

}  // namespace
}  // namespace armcmc::stress::fault_judge_test
