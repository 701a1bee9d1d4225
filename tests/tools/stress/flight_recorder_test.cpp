#include "armcmc/stress/flight_recorder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

#include "tools/file_text.hpp"

namespace armcmc::stress::flight_recorder_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class FlightRecorderTest : public ::testing::Test {
 protected:
  FlightRecorderTest() {
    std::filesystem::remove(file_);
    for (std::int64_t seq = 1; seq <= 1000; ++seq) {
      status_.last_seq = 70'000 + seq;
      status_.t_status_ns += 10'000'000;
      status_.missed_own = seq == 998 ? 1 : status_.missed_own;
      status_.fault_flags = seq == 998 ? estimator_status_t::FAULT_TRUNCATED : 0;
      recorder_.Add(status_);
    }
  }
  ~FlightRecorderTest() override { std::filesystem::remove(file_); }

  std::string Text() const { return test::TextOf(file_); }

  // Of this process: tests run side by side.
  std::filesystem::path file_ = ::testing::TempDir() + "flight_recorder_test." + std::to_string(getpid());
  FlightRecorder recorder_{file_};
  estimator_status_t status_{};
};

TEST_F(FlightRecorderTest, WritesNothingWhileAllIsWell) { EXPECT_FALSE(std::filesystem::exists(file_)); }

TEST_F(FlightRecorderTest, WritesTheNewestStatusesWithWhatRose) {
  recorder_.Write("something happened", 3);
  const std::string text = Text();
  EXPECT_THAT(text, HasSubstr("something happened\n"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 6) << "heading, columns, three statuses, an empty line";
  EXPECT_THAT(text, HasSubstr("truncated\n")) << "the flag of pack 70998";
  EXPECT_THAT(text, HasSubstr("70998"));
  EXPECT_THAT(text, HasSubstr("71000"));
  EXPECT_THAT(text, Not(HasSubstr("70997")));
}

TEST_F(FlightRecorderTest, IsBounded) {
  recorder_.Write("all");
  EXPECT_THAT(Text(), Not(HasSubstr("70600")));
  EXPECT_THAT(Text(), HasSubstr("70601"));
  for (int i = 0; i < 2 * FlightRecorder::kMostReports; ++i) recorder_.Write("again", 1);
  int reports = 0;
  std::istringstream text(Text());
  for (std::string line; std::getline(text, line);) reports += line == "all" || line == "again" ? 1 : 0;
  EXPECT_EQ(reports, FlightRecorder::kMostReports);
}

TEST_F(FlightRecorderTest, AFileThatCannotBeWrittenIsAnError) {
  FlightRecorder recorder("/dev/full");
  EXPECT_THROW(recorder.Write("full"), std::runtime_error);
}

}  // namespace
}  // namespace armcmc::stress::flight_recorder_test
