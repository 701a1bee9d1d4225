#include "armcmc/plant_sim/schedule.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace armcmc::plant_sim::schedule_test {
namespace {

TEST(Schedule, StepHoldsFromItsTimeOn) {
  const Schedule schedule({4.0, 2.3}, {{0, 8.0, 8.0, 2.0}});
  EXPECT_EQ(schedule.Value(0, 7.999), 4.0);
  EXPECT_EQ(schedule.Value(0, 8.0), 2.0);
  EXPECT_EQ(schedule.Value(0, 100.0), 2.0);
  EXPECT_EQ(schedule.Value(1, 100.0), 2.3);
}

TEST(Schedule, DriftIsLinearAndEnds) {
  const Schedule schedule({4.0}, {{0, 2.0, 10.0, 8.0}});
  EXPECT_EQ(schedule.Value(0, 2.0), 4.0);
  EXPECT_DOUBLE_EQ(schedule.Value(0, 4.0), 5.0);
  EXPECT_EQ(schedule.Value(0, 10.0), 8.0);
  EXPECT_EQ(schedule.Value(0, 11.0), 8.0);
}

TEST(Schedule, ADriftStartsWhereTheLastChangeEndedWhateverTheOrderInTheFile) {
  const Schedule schedule({1.0}, {{0, 5.0, 7.0, 5.0}, {0, 2.0, 2.0, 3.0}});
  EXPECT_EQ(schedule.Value(0, 4.0), 3.0);
  EXPECT_DOUBLE_EQ(schedule.Value(0, 6.0), 4.0);
}

TEST(Schedule, RejectsNonsense) {
  EXPECT_THROW(Schedule({1.0}, {{1, 0.0, 0.0, 2.0}}), std::invalid_argument);
  EXPECT_THROW(Schedule({1.0}, {{0, 3.0, 2.0, 2.0}}), std::invalid_argument);
  EXPECT_THROW(Schedule({1.0}, {{0, -1.0, 2.0, 2.0}}), std::invalid_argument);
  EXPECT_THROW(Schedule({1.0}, {{0, 1.0, 3.0, 2.0}, {0, 2.0, 4.0, 3.0}}), std::invalid_argument);
  EXPECT_THROW(Schedule({1.0}, {{0, 1.0, 1.0, 2.0}, {0, 1.0, 1.0, 3.0}}), std::invalid_argument);
}

}  // namespace
}  // namespace armcmc::plant_sim::schedule_test
