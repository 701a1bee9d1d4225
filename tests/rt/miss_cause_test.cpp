#include "armcmc/rt/miss_cause.hpp"

#include <gtest/gtest.h>

namespace armcmc::rt::miss_cause_test {
namespace {

TEST(Attribute, BlamesWhatAloneMadeTheStepLate) {
  EXPECT_EQ(Attribute(0, {50, 50, 100}), MissCause::kNone) << "just in time";
  EXPECT_EQ(Attribute(10, {10, 0, 10}), MissCause::kLateData);
  EXPECT_EQ(Attribute(10, {9, 0, 9}), MissCause::kOwn);
  EXPECT_EQ(Attribute(10, {0, 10, 10}), MissCause::kMachine);
  EXPECT_EQ(Attribute(10, {0, 9, 9}), MissCause::kOwn);
}

TEST(Attribute, BlamesTheLargerPartWhenOnlyBothExplainIt) {
  EXPECT_EQ(Attribute(10, {4, 6, 10}), MissCause::kMachine);
  EXPECT_EQ(Attribute(10, {6, 4, 10}), MissCause::kLateData);
  EXPECT_EQ(Attribute(10, {0, 0, 10}), MissCause::kLateData) << "either alone would have made it late";
  EXPECT_EQ(Attribute(10, {6, 6, 9}), MissCause::kOwn) << "they overlap: on a good day it had been late, too";
}

}  // namespace
}  // namespace armcmc::rt::miss_cause_test
