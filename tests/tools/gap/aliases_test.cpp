// What a recording cannot show, told before anyone trusts a name or a parameter.

#include "armcmc/gap/aliases.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "armcmc/gap/workflow.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::aliases_test {
namespace {

using test::Measure;

constexpr double kNoise = 0.1;  // N

Result Diagnosed(const Recording& recording) {
  WorkflowRequest request;
  request.model = "hunt_crossley";
  request.data = recording;
  request.diagnose.pairs = false;
  return RunWorkflow(request).result;
}

/// What is said of a recording before anything is searched for in it.
struct Asked {
  std::vector<std::string> aliases;
  double stiffness = 0.0;  ///< K of the base law; 0: the law is not seen.
};

Asked RunDiagnosis(const Recording& recording) {
  const auto equation = MakeEquation("hunt_crossley");
  const Diagnosis diagnosis = CompareOnly(*equation, recording);
  Analysis& analysis = *diagnosis.wide;
  analysis.catalogue = equation->Catalogue(analysis.signals);
  Asked asked{Aliases(*equation, analysis), 0.0};
  const Vector& theta = analysis.finding.base->fit.theta;
  if (analysis.signals.law_seen)
    asked.stiffness = equation->Report(analysis.signals, theta, Matrix::Zero(theta.size(), theta.size()))[0].mean;
  return asked;
}

/// The line that begins with these words; empty: there is none.
std::string LineOf(const std::vector<std::string>& aliases, const std::string& beginning) {
  const auto line = std::find_if(aliases.begin(), aliases.end(),
                                 [&](const std::string& text) { return text.starts_with(beginning); });
  return line == aliases.end() ? "" : *line;
}

/// "K +1.2 %" in the words after "looks like" -> 1.2.
double PercentOf(const std::string& line, const std::string& parameter) {
  const std::size_t from = line.find("looks like"), at = line.find(parameter + " ", from);
  return from == std::string::npos || at == std::string::npos ? 0.0 : std::strtod(line.c_str() + at + 2, nullptr);
}

/// Presses of a few per cent about one depth: the law is almost a straight line there.
Recording Shallow(double bias) {
  constexpr int kRows = 6000;
  Vector t(kRows), x(kRows), v(kRows), f(kRows);
  for (Eigen::Index i = 0; i < kRows; ++i) {
    t[i] = 1e-3 * static_cast<double>(i);
    x[i] = 0.6 + 0.03 * std::sin(3.0 * t[i]);
    v[i] = 0.09 * std::cos(3.0 * t[i]);
    f[i] = std::pow(x[i], 1.7) * (4.0 + 2.3 * v[i]) + bias;
  }
  return test::MakeRecording(t, x, v, f + 0.1 * kNoise * test::Noise(kRows, 3));
}

TEST(Aliases, AWrongGainPassesForTheParametersAndGetsNoName) {
  Recording recording = Measure({}, 6000, kNoise, 11).recording;
  const Result right = Diagnosed(recording);
  recording.columns.back() *= 1.05;
  const Result wrong = Diagnosed(recording);
  EXPECT_EQ(wrong.verdict, Verdict::kNone);
  const std::string line = LineOf(wrong.aliases, "a wrong gain or unit of the force");
  ASSERT_FALSE(line.empty());
  EXPECT_NEAR(PercentOf(line, "K"), 1.0, 0.01) << line;
  EXPECT_NEAR(PercentOf(line, "B"), 1.0, 0.01) << line;
  EXPECT_EQ(PercentOf(line, "p"), 0.0) << line;
  // That is what it does.
  EXPECT_NEAR(wrong.parameters[0].before.mean / right.parameters[0].before.mean, 1.05, 1e-4);
  EXPECT_NEAR(wrong.parameters[1].before.mean / right.parameters[1].before.mean, 1.05, 1e-4);
}

TEST(Aliases, ARichMotionShowsEveryEffect) {
  const Asked asked = RunDiagnosis(Measure({}, 6000, kNoise, 12).recording);
  ASSERT_FALSE(asked.aliases.empty()) << "the gain, at least";
  for (const std::string& line : asked.aliases) {
    EXPECT_EQ(line.find("never acts"), std::string::npos) << line;
    if (!line.starts_with("a wrong gain")) {
      EXPECT_EQ(line.find("absorb"), std::string::npos) << line;
    }
  }
}

TEST(Aliases, SayWhatAShallowMotionHidesWhatItPassesForAndWhatLooksAlikeInIt) {
  const Asked without = RunDiagnosis(Shallow(0.0)), with = RunDiagnosis(Shallow(0.1 * kNoise));
  const std::string line = LineOf(with.aliases, "force_bias: the parameters absorb it");
  ASSERT_FALSE(line.empty());
  const double told = PercentOf(line, "K");
  const double moved = 100.0 * (with.stiffness / without.stiffness - 1.0);
  EXPECT_GT(std::abs(told), 0.05) << line;
  EXPECT_NEAR(moved / told, 1.0, 0.2) << line;
  // One slow frequency: late by so much is a low pass, and a friction that only helps or hinders pulls one way.
  for (const char* pair : {"sensor_delay and sensor_lag", "coulomb_friction and adhesion"})
    EXPECT_FALSE(LineOf(without.aliases, std::string(pair) + " look alike").empty()) << pair;
}

TEST(Aliases, NameWhatNeverActs) {
  Recording recording = Measure({}, 6000, kNoise, 13).recording;
  recording.columns[1].array() -= 2.0;  // free motion only
  recording.columns[3] = kNoise * test::Noise(6000, 14);
  const Asked asked = RunDiagnosis(recording);
  for (const char* effect : {"stress_relaxation", "adhesion", "stiffness_drift"})
    EXPECT_FALSE(LineOf(asked.aliases, std::string(effect) + ": never acts").empty()) << effect;
  EXPECT_TRUE(LineOf(asked.aliases, "coulomb_friction: never acts").empty());
}

}  // namespace
}  // namespace armcmc::gap::aliases_test
