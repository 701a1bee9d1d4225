#include "armcmc/plant_sim/fault_plan.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace armcmc::plant_sim::fault_plan_test {
namespace {

TEST(FaultPlan, AClockThatJumpedStaysAhead) {
  const FaultPlan plan = FaultPlan::Parse("clock@5:1000,clock@9:50");
  EXPECT_EQ(plan.ClockMs(4), 0.0);
  EXPECT_EQ(plan.ClockMs(5), 1000.0);
  EXPECT_EQ(plan.ClockMs(8), 1000.0);
  EXPECT_EQ(plan.ClockMs(9), 1050.0);
}

TEST(FaultPlan, RejectsWhatItDoesNotUnderstand) {
  for (const char* list : {"", "nan", "nan@", "nan@0", "nan@-1", "nan@x", "nan@1:5", "late@1", "late@1:", "late@1:0",
                           "late@1:nan", "explode@3", "clock@1", "zero@1:5", "nan@1,", "nan@1,,drop@2", "nan@1 drop@2"})
    EXPECT_THROW(static_cast<void>(FaultPlan::Parse(list)), std::invalid_argument) << list;
}

}  // namespace
}  // namespace armcmc::plant_sim::fault_plan_test
