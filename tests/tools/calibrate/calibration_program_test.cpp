#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tools/calibrate/calibration_rig.hpp"
#include "tools/plots/browser.hpp"

namespace armcmc::test::calibration_program_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class CalibrationProgram : public CalibrationRig {};

// 30 s hold about 20 000 samples in contact: scales to 1 %, shapes to 10 %.
TEST_F(CalibrationProgram, RecoversGaussianNoise) {
  ASSERT_EQ(Calibrate(Record("kind = \"gaussian\"\nstd = 0.2", 1, "30")).code, 0);
  EXPECT_EQ(Found().noise[0].kind, NoiseKind::kGaussian);
  EXPECT_NEAR(Found().noise[0].std, 0.2, 0.008);
  EXPECT_EQ(Found().forgetting.rho, 0.0) << "nothing drifts";
}

TEST_F(CalibrationProgram, RecoversImpulsiveNoise) {
  const std::string noise = "kind = \"mixture\"\nstd = 0.1\noutlier_weight = 0.05\noutlier_scale = 10.0";
  ASSERT_EQ(Calibrate(Record(noise, 4, "30")).code, 0);
  EXPECT_EQ(Found().noise[0].kind, NoiseKind::kMixture);
  EXPECT_NEAR(Found().noise[0].std, 0.1, 0.004);
  EXPECT_NEAR(Found().noise[0].outlier_weight, 0.05, 0.01);
  EXPECT_NEAR(Found().noise[0].outlier_scale, 10.0, 1.5);
}

// The actuator's noise is that of the measured pressure rate, 500 Pa/s, where it is regressed; both valves have it.
TEST_F(CalibrationProgram, RecoversTheNoiseOfThePressureRate) {
  std::ofstream(dir_ / "start.toml") << "schema = 1\n[model]\nname = \"soft_actuator_excited\"\npressure_rate = true\n"
                                        "[noise]\nstd = 1500.0\n[sampler]\ndraws = 300\n[gap_watch]\nenabled = false\n";
  ASSERT_EQ(Calibrate(Plant("soft_actuator_excited", 6, "20")).code, 0);
  for (const std::size_t mode : {0U, 1U}) {
    EXPECT_EQ(Found().noise[mode].kind, NoiseKind::kGaussian) << mode;
    EXPECT_NEAR(Found().noise[mode].std, 500.0, 25.0) << mode;
  }
}

TEST_F(CalibrationProgram, TheReportIsDrawn) {
  ASSERT_EQ(
      Calibrate(Record("kind = \"mixture\"\nstd = 0.1\noutlier_weight = 0.05\noutlier_scale = 10.0", 8, "20")).code, 0);
  const std::string page = TextOf(dir_ / "found.html");
  EXPECT_THAT(page, HasSubstr("mixture</b> (chosen)"));
  ARMCMC_REQUIRE_BROWSER();
  const BrowserView view = View(page);
  EXPECT_THAT(view.complaints, IsEmpty());
  ASSERT_EQ(view.figures.size(), 4u);
  for (const DrawnFigure& figure : view.figures) {
    EXPECT_TRUE(figure.drawn);
    EXPECT_GT(figure.marks, 50);
  }
}

TEST_F(CalibrationProgram, ATooShortRecordingIsRefused) {
  const Outcome o = Calibrate(Record("kind = \"gaussian\"\nstd = 0.1", 9, "4"));
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("packs, expected at least 40"));
}

TEST_F(CalibrationProgram, ARecordingWithoutNoiseIsRefused) {
  const Outcome o = Calibrate(Record("kind = \"gaussian\"\nstd = 1e-14", 9, "10"));
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("holds no noise"));
}

}  // namespace
}  // namespace armcmc::test::calibration_program_test
