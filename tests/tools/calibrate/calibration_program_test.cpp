#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "armcmc/support/estimator_config.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/plots/browser.hpp"

namespace armcmc::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Calibrations from runs of the simulated plant, whose noise is known.
class CalibrationProgram : public ::testing::Test {
 protected:
  CalibrationProgram() {
    std::ofstream(dir_ / "start.toml") << "schema = 1\n[model]\nname = \"hunt_crossley\"\n[noise]\nstd = 0.05\n"
                                          "[sampler]\ndraws = 300\n[gap_watch]\nenabled = false\n";
  }
  std::string Text(const std::string& name) {
    std::ifstream file(dir_ / name);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  /// A recording of the paper's contact with that noise.
  std::string Record(const std::string& noise, int seed, const std::string& seconds) {
    std::ofstream(dir_ / "scenario.toml")
        << "schema = 1\nplant = \"hunt_crossley\"\nduration_s = 20.0\nsample_interval_s = 0.001\npack_period_s = 0.1\n"
           "[parameters]\nK = 4.0\nB = 2.3\np = 1.7\n[motion]\nmaster_offset = 0.6\nmaster_amplitude = [1.0]\n"
           "master_omega = [1.0]\n[noise.f]\n"
        << noise << "\n";
    return Plant(dir_ / "scenario.toml", seed, seconds);
  }
  std::string Plant(const std::string& scenario, int seed, const std::string& seconds) {
    const std::string csv = dir_ / ("run" + std::to_string(seed) + ".csv");
    const Outcome o = RunProgram(Program("armcmc-plant"), {"--scenario", scenario, "--seed", std::to_string(seed),
                                                           "--duration", seconds, "--csv", csv});
    EXPECT_EQ(o.code, 0) << o.err;
    return csv;
  }
  Outcome Calibrate(const std::string& csv, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"--config", dir_ / "start.toml", "--data", csv, "--calibrate", dir_ / "found.toml"});
    return RunProgram(Program("armcmc-replay"), more, std::chrono::seconds(200));
  }
  EstimatorSettings Found() {
    auto root = support::StrictTable::FromFile(dir_ / "found.toml");
    return support::ReadEstimatorSettings(root, "");
  }
  struct Decisions {
    int informative = 0;
    std::vector<int> modifications;  ///< Pack numbers, the first pack left out.
  };
  Decisions Replay(const std::string& csv) {
    const Outcome o = RunProgram(Program("armcmc-replay"),
                                 {"--config", dir_ / "found.toml", "--data", csv, "--out", dir_ / "out.csv"});
    EXPECT_EQ(o.code, 0) << o.err;
    Decisions decisions;
    std::istringstream rows(Text("out.csv"));
    for (std::string row; std::getline(rows, row);) {
      if (row.find("hold,") != std::string::npos || row.starts_with("pack")) continue;
      ++decisions.informative;
      if (row.find("modification") != std::string::npos && decisions.informative > 1)
        decisions.modifications.push_back(std::stoi(row));
    }
    return decisions;
  }
  ScratchDir dir_;
};

// 30 s hold about 20 000 samples in contact: scales to 1 %, shapes to 10 %.
TEST_F(CalibrationProgram, RecoversGaussianNoise) {
  ASSERT_EQ(Calibrate(Record("kind = \"gaussian\"\nstd = 0.2", 1, "30")).code, 0);
  EXPECT_EQ(Found().noise[0].kind, NoiseKind::kGaussian);
  EXPECT_NEAR(Found().noise[0].std, 0.2, 0.008);
  EXPECT_EQ(Found().forgetting.rho, 0.0) << "nothing drifts";
}

TEST_F(CalibrationProgram, RecoversLaplaceNoise) {
  ASSERT_EQ(Calibrate(Record("kind = \"laplace\"\nstd = 0.1", 2, "30")).code, 0);
  EXPECT_EQ(Found().noise[0].kind, NoiseKind::kLaplace);
  EXPECT_NEAR(Found().noise[0].std, 0.1, 0.004);
}

TEST_F(CalibrationProgram, RecoversStudentTNoise) {
  ASSERT_EQ(Calibrate(Record("kind = \"student_t\"\nstd = 0.02\ndof = 3.0", 3, "30")).code, 0);
  EXPECT_EQ(Found().noise[0].kind, NoiseKind::kStudentT);
  EXPECT_NEAR(Found().noise[0].std, 0.02, 0.001);
  EXPECT_NEAR(Found().noise[0].dof, 3.0, 0.5);
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

// Correlated noise is what no noise law knows and what the built-in allowance is too small for: there the threshold
// has work to do. 830 packs of calibration and 3 x 830 packs of fresh seeds at 2 %: 17 and 50 expected.
TEST_F(CalibrationProgram, FalseModificationsOfFreshSeedsAreNearWhatWasAskedFor) {
  const std::string noise = "kind = \"gaussian\"\nstd = 0.1\ncorrelation = 0.9";
  constexpr double kRate = 0.02;
  const Outcome o = Calibrate(Record(noise, 5, "120"), {"--false-modifications", "0.02"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("an error says something about the next"));
  int packs = 0, modifications = 0;
  for (const int seed : {21, 22, 23}) {
    const Decisions d = Replay(Record(noise, seed, "120"));
    packs += d.informative;
    modifications += static_cast<int>(d.modifications.size());
  }
  EXPECT_GT(packs, 2'000);
  const double rate = static_cast<double>(modifications) / packs;
  EXPECT_GT(rate, kRate / 2.5);
  EXPECT_LT(rate, kRate * 2.5);
}

TEST_F(CalibrationProgram, IndependentNoiseIsNeverTakenForAChangeAndAChangeIs) {
  ASSERT_EQ(Calibrate(Record("kind = \"gaussian\"\nstd = 0.1", 6, "60")).code, 0);
  int modifications = 0;
  for (const int seed : {31, 32}) {
    modifications +=
        static_cast<int>(Replay(Record("kind = \"gaussian\"\nstd = 0.1", seed, "60")).modifications.size());
  }
  EXPECT_LE(modifications, 2) << "0.1 % of 850 packs were allowed";
  // K halves at 8 s and comes back at 14.5 s: packs 81 and 146 hold the first samples, 80 and 145 the last ones before.
  const std::vector<int> seen =
      Replay(Plant((SourceDir() / "plant_sim/scenarios/hunt_crossley_step.toml").string(), 7, "20")).modifications;
  const auto near = [&seen](int pack) {
    return std::any_of(seen.begin(), seen.end(), [pack](int s) { return std::abs(s - pack) <= 1; });
  };
  EXPECT_TRUE(near(81)) << ::testing::PrintToString(seen);
  EXPECT_TRUE(near(146)) << ::testing::PrintToString(seen);
}

TEST_F(CalibrationProgram, TheReportIsDrawn) {
  ASSERT_EQ(
      Calibrate(Record("kind = \"mixture\"\nstd = 0.1\noutlier_weight = 0.05\noutlier_scale = 10.0", 8, "20")).code, 0);
  const std::string page = Text("found.html");
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
}  // namespace armcmc::test
