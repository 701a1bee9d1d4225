#include "armcmc/watch/sparkline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "armcmc/watch/text_line.hpp"

namespace armcmc::watch::sparkline_test {
namespace {

TEST(Sparkline, GoesFromTheLeastToTheLargest) {
  const std::vector<double> ramp = {0, 1, 2, 3, 4, 5, 6, 7};
  EXPECT_EQ(Sparkline(ramp, Glyphs::kUnicode), "▁▂▃▄▅▆▇█");
  EXPECT_EQ(Sparkline(ramp, Glyphs::kAscii), ".:-=+*#@");
}

TEST(Sparkline, LeavesGapsAndDrawsConstantsAtHalfHeight) {
  const std::vector<double> values = {5, std::nan(""), 5};
  EXPECT_EQ(Sparkline(values, Glyphs::kAscii), "+ +");
  EXPECT_EQ(Sparkline(std::vector<double>{}, Glyphs::kAscii), "");
  EXPECT_EQ(Sparkline(std::vector<double>{std::nan(""), HUGE_VAL}, Glyphs::kUnicode), "  ");
}

TEST(Bar, IsAlwaysAsWideAsAsked) {
  for (const double share : {-1.0, 0.0, 0.001, 0.0624, 0.5, 0.99, 1.0, 7.0, std::nan("")}) {
    for (const Glyphs glyphs : {Glyphs::kUnicode, Glyphs::kAscii}) EXPECT_EQ(Columns(Bar(share, 20, glyphs)), 20);
  }
}

TEST(Bar, FillsInEighthsOrWholeColumns) {
  EXPECT_EQ(Bar(0.5, 4, Glyphs::kUnicode), "██  ");
  EXPECT_EQ(Bar(0.125 + 1.0 / 64.0, 4, Glyphs::kUnicode), "▌   ");
  EXPECT_EQ(Bar(0.5, 4, Glyphs::kAscii), "##  ");
  EXPECT_EQ(Bar(0.01, 4, Glyphs::kAscii), ".   ") << "a stage that ran is not nothing";
  EXPECT_EQ(Bar(2.0, 4, Glyphs::kAscii), "####");
}

TEST(DensityLine, AveragesBinsIntoColumns) {
  const std::vector<double> bins = {0, 0, 8, 8, 4, 4, 0, 0};
  EXPECT_EQ(DensityLine(bins, 4, Glyphs::kAscii), ".@+.");
  EXPECT_EQ(Columns(DensityLine(bins, 8, Glyphs::kUnicode)), 8);
}

}  // namespace
}  // namespace armcmc::watch::sparkline_test
