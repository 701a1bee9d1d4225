#include "armcmc/stress/fault_layout.hpp"

#include <gtest/gtest.h>

namespace armcmc::stress::fault_layout_test {
namespace {

TEST(LayOut, GivesEveryFaultASlotOfItsOwnAfterTheLearning) {
  const FaultLayout layout = LayOut(SelectFaults("all"), 0, 100.0, 10'000);
  std::int64_t end = LearningPacks(100.0);
  for (const Slot& slot : layout.slots) {
    EXPECT_EQ(slot.begin, end) << slot.fault->name;
    EXPECT_GE(slot.end - slot.at() - slot.fault->LastsPacks(100.0), 6) << "room to see a recovery that is too slow";
    end = slot.end;
  }
  EXPECT_EQ(layout.last_pack, end);
  EXPECT_GE(layout.slots.size(), 15U);
}

TEST(LayOut, PutsEachFaultIntoThePlanOfTheOneThatMakesIt) {
  const FaultLayout layout = LayOut(SelectFaults("nan,overload,plant_stop,plant_death"), 0, 100.0, 10'000);
  ASSERT_EQ(layout.slots.size(), 3U) << "a plant's end takes no slot";
  EXPECT_EQ(layout.plant_plan, "nan@" + std::to_string(layout.slots[0].at()));
  EXPECT_EQ(layout.estimator_plan, "squeeze@" + std::to_string(layout.slots[1].at()));
}

TEST(LayOut, GoesOnWhereTheOneBeforeEnded) {
  const auto faults = SelectFaults("nan,huge,lost,late");
  const FaultLayout layout = LayOut(faults, 3, 100.0, 10'000);
  ASSERT_EQ(layout.slots.size(), 4U);
  EXPECT_STREQ(layout.slots[0].fault->name, "late");
  EXPECT_STREQ(layout.slots[1].fault->name, "nan");
}

TEST(LayOut, StopsWhereThePacksEnd) {
  const auto all = SelectFaults("all");
  const std::int64_t end = LayOut(all, 0, 100.0, 10'000).slots[2].end;
  EXPECT_EQ(LayOut(all, 0, 100.0, end).slots.size(), 3U);
  EXPECT_EQ(LayOut(all, 0, 100.0, end - 1).slots.size(), 2U);
  EXPECT_TRUE(LayOut(all, 0, 100.0, 3).slots.empty());
}

}  // namespace
}  // namespace armcmc::stress::fault_layout_test
