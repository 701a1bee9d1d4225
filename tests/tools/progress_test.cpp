#include "armcmc/support/progress.hpp"

#include <gtest/gtest.h>

namespace armcmc::support::progress_test {
namespace {

TEST(Progress, LineShowsShareAndRemainingTime) {
  EXPECT_EQ(Progress::Line("replay", 0.5, 3.2, 40), "replay [#######........] 50 %, 4 s left");
  EXPECT_EQ(Progress::Line("replay", 1.0, 0.0, 40), "replay [##############] 100 %, 0 s left");
  EXPECT_EQ(Progress::Line("replay", 0.0, -1.0, 200), "replay [" + std::string(40, '.') + "] 0 %");
}

TEST(Progress, LineFitsTheTerminal) {
  for (int width = 30; width < 120; ++width) {
    EXPECT_LT(Progress::Line("replay", 0.3, 12.0, width).size(), static_cast<std::size_t>(width));
  }
  EXPECT_EQ(Progress::Line("replay", 0.3, -1.0, 5), "replay 30 %");
}

TEST(Progress, ShareOutsideItsRangeIsClamped) {
  EXPECT_EQ(Progress::Line("p", 7.0, -1.0, 20), Progress::Line("p", 1.0, -1.0, 20));
  EXPECT_EQ(Progress::Line("p", -7.0, -1.0, 20), Progress::Line("p", 0.0, -1.0, 20));
}

TEST(Progress, IsSilentWhenStderrIsNoTerminal) {
  ::testing::internal::CaptureStderr();
  {
    Progress progress("work");
    for (int i = 0; i <= 10; ++i) progress.Update(0.1 * i);
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(Progress, NotesAreSeenOnNoTerminalToo) {
  ::testing::internal::CaptureStderr();
  Progress("work").Note("half of it");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "work: half of it\n");
}

}  // namespace
}  // namespace armcmc::support::progress_test
