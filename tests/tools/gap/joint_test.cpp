// What one recording leaves open is judged by another.

#include "armcmc/gap/joint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tools/gap/findings.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::joint_test {
namespace {

using armcmc::test::HiddenEffect;
using test::Measure;
using test::SetHolds;

HiddenEffect Weak(const std::string& name, double amplitude) {
  HiddenEffect effect = test::Hidden(name);
  effect.amplitude[0] = amplitude;
  return effect;
}

/// One sine, always in contact: what is constant and what follows the acceleration look the same.
Recording Sine(const HiddenEffect& effect, double noise_sd, unsigned seed) {
  constexpr int kRows = 6000;
  armcmc::test::Series series(kRows);
  for (std::size_t i = 0; i < series.size(); ++i) {
    const double phase = 2.0 * std::numbers::pi * series.t[i];
    series.x[i] = 0.6 + 0.3 * std::sin(phase);
    series.v[i] = 0.6 * std::numbers::pi * std::cos(phase);
  }
  armcmc::test::Simulate({effect}, &series);
  return test::RecordingOf(series, noise_sd, seed);
}

class JoinTest : public ::testing::Test {
 protected:
  void Judge(const HiddenEffect& first_effect, const HiddenEffect& second_effect, double second_noise) {
    options_.pairs = false;
    first_ = Diagnose(*equation_, Sine(first_effect, 0.01, 3), options_);
    LeaveOpen({"force_bias", "inertia"});
    recording_ = Measure({second_effect}, 6000, second_noise, 4).recording;
    second_ = Diagnose(*equation_, recording_, options_);
    alone_ = second_.finding.verdict;
    Join(*equation_, recording_, first_, options_.thresholds, &second_, &notes_);
  }
  /// As if the first recording could not tell these apart, whatever its noise.
  void LeaveOpen(const std::vector<std::string>& effects) {
    first_.finding.verdict = Verdict::kAmbiguous;
    first_.finding.set.clear();
    for (const std::string& effect : effects)
      for (const CandidatePtr& tried : first_.finding.tried)
        if (tried->exact() && tried->names() == std::vector<std::string>{effect} && !SetHolds(first_.finding, effect))
          first_.finding.set.push_back(tried);
    ASSERT_EQ(first_.finding.set.size(), effects.size());
  }

  std::unique_ptr<Equation> equation_ = std::move(MakeEquations("hunt_crossley").front());
  DiagnoseOptions options_;
  Recording recording_;
  Diagnosis first_, second_;
  Verdict alone_ = Verdict::kNone;
  std::vector<std::string> notes_;
};

TEST_F(JoinTest, ABiasTooWeakToBeNamedAgainIsStillToldFromItsRival) {
  Judge(Weak("force_bias", 0.05), Weak("force_bias", 0.05), 0.7);
  EXPECT_EQ(alone_, Verdict::kNone);
  EXPECT_EQ(second_.finding.verdict, Verdict::kNamed);
  EXPECT_TRUE(SetHolds(second_.finding, "force_bias"));
  EXPECT_EQ(notes_.size(), 1u);
}

TEST_F(JoinTest, ARecordingOfAnotherEffectKeepsItsOwnVerdict) {
  Judge(Weak("force_bias", 0.05), Weak("stress_relaxation", 2.0), 0.02);
  EXPECT_FALSE(SetHolds(second_.finding, "force_bias"));
  EXPECT_FALSE(SetHolds(second_.finding, "inertia"));
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("disagree"), std::string::npos) << notes_[0];
}

class LongJoinTest : public JoinTest {};

TEST_F(LongJoinTest, ALatencyIsJudgedByARecordingSampledMoreOften) {
  HiddenEffect delay = test::Hidden("sensor_delay"), lag = test::Hidden("sensor_lag");
  for (const bool delayed : {true, false}) {
    const HiddenEffect& truth = delayed ? delay : lag;
    options_.pairs = false;
    first_ = Diagnose(*equation_, Measure({truth}, 3000, 0.05, 5).recording, options_);
    LeaveOpen({"sensor_delay", "sensor_lag"});
    recording_ = Measure({truth}, 12000, 0.06, 6, 0.25e-3).recording;
    second_ = Diagnose(*equation_, recording_, options_);
    second_.finding.verdict = Verdict::kNone;  // as if it named nothing by itself
    notes_.clear();
    Join(*equation_, recording_, first_, options_.thresholds, &second_, &notes_);
    ASSERT_EQ(second_.finding.set.size(), 1u) << (notes_.empty() ? "" : notes_[0]);
    EXPECT_TRUE(SetHolds(second_.finding, delayed ? "sensor_delay" : "sensor_lag")) << notes_[0];
    const double before = first_.finding.set[delayed ? 0 : 1]->fit.theta.tail<1>()[0];
    EXPECT_NEAR(second_.finding.best->fit.theta.tail<1>()[0], before, 0.1 * before);
  }
}

TEST_F(JoinTest, EachRecordingHasItsOwnStart) {
  const HiddenEffect truth = test::Hidden("stress_relaxation");
  options_.pairs = false;
  first_ = Diagnose(*equation_, Measure({truth}, 3000, 0.05, 5).recording, options_);
  LeaveOpen({"stress_relaxation", "adhesion"});
  recording_ = Measure({truth}, 3300, 2.0, 6).recording.Slice(300, 3000);  // begins in the middle of a press
  second_ = Diagnose(*equation_, recording_, options_);
  second_.finding.verdict = Verdict::kNone;  // as if it named nothing by itself
  Join(*equation_, recording_, first_, options_.thresholds, &second_, &notes_);
  ASSERT_EQ(second_.finding.set.size(), 1u) << (notes_.empty() ? "" : notes_[0]);
  ASSERT_TRUE(SetHolds(second_.finding, "stress_relaxation"));
  const double before = first_.finding.set[0]->fit.theta.tail<1>()[0];
  const Fitted& fit = second_.finding.best->fit;
  ASSERT_EQ(fit.coordinates.back().name, "start");
  EXPECT_NEAR(before, 1.0, 0.15);
  EXPECT_LT(fit.theta.tail<1>()[0], before - 0.2);
  EXPECT_NEAR(fit.squares / (second_.wide->fitter->whitener().variance * 3000.0), 1.0, 0.08);
}

}  // namespace
}  // namespace armcmc::gap::joint_test
