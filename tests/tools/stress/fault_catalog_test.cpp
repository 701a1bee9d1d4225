#include "armcmc/stress/fault_catalog.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace armcmc::stress::fault_catalog_test {
namespace {

TEST(FaultCatalog, NothingIsDetectedWhereNothingHappened) {
  for (const FaultSpec& fault : FaultCatalog()) EXPECT_FALSE(fault.detected(Evidence{})) << fault.name;
}

TEST(FaultCatalog, ACounterWithoutItsFlagIsNotEnough) {
  Evidence evidence;
  evidence.after.rejected_value = 1;
  const FaultSpec& nan = *SelectFaults("nan").front();
  EXPECT_FALSE(nan.detected(evidence));
  evidence.flags = estimator_status_t::FAULT_BAD_DATA;
  EXPECT_TRUE(nan.detected(evidence));
}

TEST(SelectFaults, TakesAListAllOrNone) {
  EXPECT_EQ(SelectFaults("all").size(), FaultCatalog().size());
  EXPECT_TRUE(SelectFaults("none").empty());
  ASSERT_EQ(SelectFaults("late,nan").size(), 2U);
  EXPECT_STREQ(SelectFaults("late,nan")[0]->name, "late");
  EXPECT_THROW((void)SelectFaults("nan,explode"), std::invalid_argument);
}

TEST(FaultSpec, ItsPlanItemHasTheAmountThatItsKindNeeds) {
  EXPECT_EQ(SelectFaults("nan").front()->PlanItem(7, 100.0), "nan@7");
  EXPECT_EQ(SelectFaults("late").front()->PlanItem(7, 100.0), "late@7:150");
  EXPECT_EQ(SelectFaults("hang_adjust").front()->PlanItem(7, 100.0), "hang_adjust@7:300");
  EXPECT_EQ(SelectFaults("hang_adjust").front()->PlanItem(7, 1.0), "hang_adjust@7:40") << "long enough to be seen";
  EXPECT_EQ(SelectFaults("publish_failure").front()->PlanItem(7, 100.0), "publish@7:3");
  EXPECT_EQ(SelectFaults("reordered").front()->PlanItem(7, 100.0), "reorder@7");
}

TEST(FlagNames, NamesEveryBit) {
  EXPECT_EQ(FlagNames(0), "");
  const std::int32_t bad_data = estimator_status_t::FAULT_BAD_DATA, hung = estimator_status_t::FAULT_STAGE_HUNG;
  EXPECT_EQ(FlagNames(bad_data | hung), "bad_data|stage_hung");
}

}  // namespace
}  // namespace armcmc::stress::fault_catalog_test
