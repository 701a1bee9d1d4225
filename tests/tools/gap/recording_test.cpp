#include "armcmc/gap/recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "armcmc/support/csv.hpp"
#include "armcmc/support/program.hpp"
#include "support/paths.hpp"

namespace armcmc::gap::recording_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ReadRecordingTest : public ::testing::Test {
 protected:
  /// Samples of x = 5 t at these times, the velocity in some unit.
  [[nodiscard]] Recording Read(const std::vector<double>& times, double unit = 1.0) const {
    std::ofstream file(dir_ / "run.csv");
    file << "t,x,v,f\n";
    for (const double t : times)
      file << support::ExactNumber(t) << ',' << support::ExactNumber(5.0 * t) << ',' << support::ExactNumber(5.0 * unit)
           << ",1\n";
    file.close();
    return ReadRecording((dir_ / "run.csv").string(), {"t", "x", "v", "f"}, /*skip_bad=*/false);
  }
  [[nodiscard]] static std::vector<double> Even(int rows) {
    std::vector<double> times;
    for (int i = 0; i < rows; ++i) times.push_back(1e-3 * i);
    return times;
  }
  static void ExpectEven(const Recording& recording, Eigen::Index rows) {
    ASSERT_EQ(recording.rows(), rows);
    EXPECT_NEAR(recording.dt, 1e-3, 1e-12);
    for (Eigen::Index i = 0; i < rows; ++i) {
      EXPECT_NEAR(recording.t[i], 1e-3 * static_cast<double>(i), 1e-9) << i;
      EXPECT_NEAR(recording.Column("x")[i], 5.0 * recording.t[i], 1e-9) << i;
    }
  }

  armcmc::test::ScratchDir dir_;
};

TEST_F(ReadRecordingTest, TakesEvenSamplesAsTheyAre) {
  const Recording recording = Read(Even(101));
  ExpectEven(recording, 101);
  EXPECT_THAT(recording.notes, IsEmpty());
}

TEST_F(ReadRecordingTest, PutsJitterOnAnEvenGridAndSaysSo) {
  std::vector<double> times = Even(101);
  for (std::size_t i = 5; i < 100; i += 10) times[i] += 2e-4;
  const Recording recording = Read(times);
  ExpectEven(recording, 101);
  EXPECT_THAT(recording.notes, ElementsAre(HasSubstr("20 of 101 sample intervals are uneven")));
}

TEST_F(ReadRecordingTest, BridgesOneHoleAndRefusesMany) {
  std::vector<double> times = Even(201);
  times.erase(times.begin() + 50);
  ExpectEven(Read(times), 201);
  for (const int i : {150, 120, 90, 20}) times.erase(times.begin() + i);
  try {
    (void)Read(times);
    ADD_FAILURE() << "five holes were bridged";
  } catch (const support::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("run.csv: 5 gaps between samples"));
  }
}

TEST_F(ReadRecordingTest, SaysWhenSpeedsAreNotThoseOfThePositions) {
  EXPECT_THAT(Read(Even(101), 1e3).notes, ElementsAre(HasSubstr("v is 1e+03 times the derivative of x")));
  EXPECT_THAT(Read(Even(101), -1.0).notes, ElementsAre(HasSubstr("v is -1 times the derivative of x")));
}

}  // namespace
}  // namespace armcmc::gap::recording_test
