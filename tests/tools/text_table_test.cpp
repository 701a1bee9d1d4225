#include "armcmc/support/text_table.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace armcmc::support::text_table_test {
namespace {

TEST(TextTable, AlignsNamesLeftAndNumbersRight) {
  TextTable table({"stage", "p50", "max"});
  table.AddRow({"collect", "0.1", "12.5"});
  table.AddRow({"adjust", "3"});
  EXPECT_EQ(table.ToString(),
            "stage    p50   max\n"
            "------------------\n"
            "collect  0.1  12.5\n"
            "adjust     3\n");
}

TEST(TextTable, AlignsWordsLeft) {
  TextTable table({"plant", "what it is"}, TextTable::Content::kWords);
  table.AddRow({"axis", "an axis"});
  EXPECT_EQ(table.ToString(), "plant  what it is\n-----------------\naxis   an axis\n");
}

TEST(TextTable, RefusesMoreCellsThanColumns) {
  TextTable table({"a"});
  EXPECT_THROW(table.AddRow({"1", "2"}), std::invalid_argument);
}

TEST(Significant, RoundsAndMarksWhatIsNotFinite) {
  EXPECT_EQ(Significant(3.14159, 3), "3.14");
  EXPECT_EQ(Significant(0.000123456, 2), "0.00012");
  EXPECT_EQ(Significant(std::numeric_limits<double>::quiet_NaN(), 3), "-");
}

}  // namespace
}  // namespace armcmc::support::text_table_test
