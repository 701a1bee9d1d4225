#include "armcmc/plant_sim/fault_plan.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace armcmc::plant_sim {
namespace {

TEST(FaultPlan, ReadsEveryKind) {
  const FaultPlan plan = FaultPlan::Parse("nan@1,size@2,duplicate@3,reorder@4,drop@5,foreign@6,garbage@7,late@8:12.5");
  EXPECT_TRUE(plan.Has(FaultKind::kNan, 1));
  EXPECT_TRUE(plan.Has(FaultKind::kSize, 2));
  EXPECT_TRUE(plan.Has(FaultKind::kDuplicate, 3));
  EXPECT_TRUE(plan.Has(FaultKind::kReorder, 4));
  EXPECT_TRUE(plan.Has(FaultKind::kDrop, 5));
  EXPECT_TRUE(plan.Has(FaultKind::kForeign, 6));
  EXPECT_TRUE(plan.Has(FaultKind::kGarbage, 7));
  EXPECT_EQ(plan.LateMs(8), 12.5);
  EXPECT_EQ(plan.LateMs(7), 0.0);
  EXPECT_FALSE(plan.Has(FaultKind::kNan, 2));
}

TEST(FaultPlan, AClockThatJumpedStaysAhead) {
  const FaultPlan plan = FaultPlan::Parse("clock@5:1000,zero@6,huge@7,corrupt@8,clock@9:50");
  EXPECT_TRUE(plan.Has(FaultKind::kZero, 6));
  EXPECT_TRUE(plan.Has(FaultKind::kHuge, 7));
  EXPECT_TRUE(plan.Has(FaultKind::kCorrupt, 8));
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
}  // namespace armcmc::plant_sim
