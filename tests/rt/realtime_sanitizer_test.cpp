// Faults planted into a stage are caught at run time.
#include <gtest/gtest.h>

#include "armcmc/rt/clock.hpp"
#include "stage_rig.hpp"

namespace armcmc::rt::realtime_sanitizer_test {
namespace {

#if !defined(ARMCMC_RTSAN_RUNS)
#error "these tests are for the preset rtsan"
#endif

class RealtimeSanitizer : public test::StageRig {
 protected:
  void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }

  /// One pack through the adjust stage, as its thread calls it.
  void Step(test::Planted planted) {
    engine_.planted = planted;
    Push(1, kNanosPerSecond);
    (void)adjust_.Step();
  }
};

TEST_F(RealtimeSanitizer, LetsAStepThatDoesNothingWrongPass) {
  Step(test::Planted::kNothing);
  EXPECT_EQ(engine_.adjusted.load(), 1);
}

TEST_F(RealtimeSanitizer, CatchesAnAllocationInAStage) {
  EXPECT_DEATH(Step(test::Planted::kAllocation), "RealtimeSanitizer: unsafe-library-call(.|\n)*malloc");
}

TEST_F(RealtimeSanitizer, CatchesALockInAStage) {
  EXPECT_DEATH(Step(test::Planted::kLock), "RealtimeSanitizer: unsafe-library-call(.|\n)*pthread_mutex_lock");
}

TEST_F(RealtimeSanitizer, CatchesASystemCallInAStage) {
  EXPECT_DEATH(Step(test::Planted::kSystemCall), "RealtimeSanitizer: unsafe-library-call(.|\n)*nanosleep");
}

TEST_F(RealtimeSanitizer, KnowsTheWaitsThatAreMeantAndNothingBeyondTheirScope) {
  struct Thread {
    static void Run() noexcept ARMCMC_NONBLOCKING {
      SleepUntil(1);
      test::PlantedFault(test::Planted::kSystemCall);
    }
    static void Wait() noexcept ARMCMC_NONBLOCKING { SleepUntil(1); }
  };
  Thread::Wait();
  EXPECT_DEATH(Thread::Run(), "RealtimeSanitizer: unsafe-library-call(.|\n)*nanosleep");
}

}  // namespace
}  // namespace armcmc::rt::realtime_sanitizer_test
