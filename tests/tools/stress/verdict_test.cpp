#include "armcmc/stress/verdict.hpp"

#include <gtest/gtest.h>

namespace armcmc::stress::verdict_test {
namespace {

PhaseResult GoodPhase() {
  PhaseResult phase;
  phase.load = "cpu";
  phase.report = {{"steps", 5000}, {"period_ms", 100.0}, {"allocations", {{"collect", 0}, {"adjust", 0}}}};
  FaultTally tally;
  tally.fault = SelectFaults("nan").front();
  tally.injected = tally.detected = 3;
  tally.recovered_steps = 5;
  phase.faults.push_back(tally);
  return phase;
}

TEST(Judge, PassesWhatIsDetectedAndGotOver) {
  const Verdict verdict = Judge({GoodPhase(), GoodPhase()});
  EXPECT_TRUE(verdict.passed);
  EXPECT_EQ(verdict.Text(), "passed");
}

TEST(Judge, RefusesAFaultThatWasMissedOnce) {
  PhaseResult phase = GoodPhase();
  phase.faults[0].detected = 2;
  EXPECT_EQ(Judge({GoodPhase(), phase}).Text(), "failed: nan detected 5 of 6");
}

TEST(Judge, RefusesASlowRecovery) {
  PhaseResult phase = GoodPhase();
  phase.faults[0].recovered_steps = 6;
  phase.faults[0].hindrance = "truncated";
  EXPECT_EQ(Judge({phase}).Text(), "failed: nan: recovered after 6 steps (truncated)");
}

TEST(Judge, RefusesOwnMissesThatNoFaultExplains) {
  PhaseResult phase = GoodPhase();
  phase.own_misses_outside = 1;
  EXPECT_FALSE(Judge({phase}).passed);
  phase.report["period_ms"] = 1.0;
  phase.own_misses_outside = 5;
  phase.report["steps"] = 50'000;
  EXPECT_TRUE(Judge({phase}).passed) << "one in ten thousand at 1 kHz";
  phase.own_misses_outside = 6;
  EXPECT_FALSE(Judge({phase}).passed);
}

TEST(Judge, RefusesHeapCallsAndADeadEstimator) {
  PhaseResult phase = GoodPhase();
  phase.report["allocations"]["adjust"] = 2;
  EXPECT_FALSE(Judge({phase}).passed);
  PhaseResult dead;
  dead.load = "io";
  dead.trouble = "the estimator ended with 139";
  EXPECT_FALSE(Judge({dead}).passed);
}

}  // namespace
}  // namespace armcmc::stress::verdict_test
