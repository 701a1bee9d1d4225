#include "armcmc/watch/text_line.hpp"

#include <gtest/gtest.h>

namespace armcmc::watch::text_line_test {
namespace {

TEST(TextLine, CutsAtTheColumnAndNotInsideACharacter) {
  TextLine line;
  line.Add("ab").Add("▁▂▃", Ink::kBad);
  EXPECT_EQ(line.columns(), 5);
  EXPECT_EQ(line.Text(4, false), "ab▁▂");
  EXPECT_EQ(line.Text(100, false), "ab▁▂▃");
  EXPECT_EQ(line.Text(0, true), "");
}

TEST(TextLine, EndsEveryColourThatItBegins) {
  TextLine line;
  line.Add("x").Add("bad", Ink::kAlarm);
  EXPECT_EQ(line.Text(3, true), "x\x1b[1;97;41mba\x1b[0m");
  EXPECT_EQ(line.Text(1, true), "x");
}

TEST(TextLine, AlignsInFields) {
  TextLine line;
  line.AddLeft("long name", 4).AddRight("7", 3).To(9).Add("|");
  EXPECT_EQ(line.Text(80, false), "long  7  |");
}

}  // namespace
}  // namespace armcmc::watch::text_line_test
