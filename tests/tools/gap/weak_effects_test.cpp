// The probability that nothing is missing, where nothing is named.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/workflow.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::weak_effects_test {
namespace {

using armcmc::test::HiddenEffect;
using test::Made;
using test::Measure;

Diagnosis Judge(const std::vector<HiddenEffect>& effects, double noise_sd, unsigned seed) {
  static const auto equation = std::move(MakeEquations("hunt_crossley").front());
  return Diagnose(*equation, Measure(effects, 6000, noise_sd, seed).recording);
}

/// A contact that is touched for a fifth of the time.
Recording ShortTaps(int rows, double noise_sd, unsigned seed) {
  armcmc::test::Series taps(rows);
  for (std::size_t i = 0; i < taps.size(); ++i) {
    const double t = taps.t[i];
    taps.x[i] = -0.4 + 0.5 * std::sin(3.1 * t - 0.4) + 0.3 * std::sin(7.3 * t) + 0.12 * std::sin(17.9 * t + 1.0);
    taps.v[i] = 1.55 * std::cos(3.1 * t - 0.4) + 2.19 * std::cos(7.3 * t) + 2.148 * std::cos(17.9 * t + 1.0);
  }
  armcmc::test::Simulate({}, &taps);
  return test::RecordingOf(taps, noise_sd, seed);
}

TEST(WeakEffects, NothingIsProbableWhereNothingIsHidden) {
  double sum = 0.0;
  for (const unsigned seed : {11U, 12U, 13U, 14U}) {
    const Finding finding = Judge({}, 0.1, seed).finding;
    EXPECT_EQ(finding.verdict, Verdict::kNone);
    sum += finding.p_none;
  }
  EXPECT_GT(sum / 4.0, 0.7);
  // An effect of a thirtieth of the noise could not have been seen.
  EXPECT_LT(sum / 4.0, 0.995);
}

TEST(WeakEffects, AnEffectTooWeakToBeNamedIsHeldProbable) {
  HiddenEffect bias = test::Hidden("force_bias");
  bias.amplitude[0] = 0.007;  // N, 0.07 of the noise: 5 standard deviations
  const Diagnosis diagnosis = Judge({bias}, 0.1, 21);
  const Finding& finding = diagnosis.finding;
  EXPECT_EQ(finding.verdict, Verdict::kNone);
  EXPECT_LT(finding.p_none, 0.1);
  double total = finding.p_none, of_bias = 0.0;
  for (const CandidatePtr& candidate : finding.tried) {
    total += candidate->probability;
    if (candidate->names() == std::vector<std::string>{"force_bias"}) of_bias += candidate->probability;
  }
  EXPECT_NEAR(total, 1.0, 1e-9);
  EXPECT_GT(of_bias, 0.5);
}

TEST(WeakEffects, ANoiseThatIsStrongerInContactIsNoErrorOfTheLaw) {
  // The law acts in a fifth of the rows, in which the noise is twice as strong as on average: 25 bumps that take what
  // they take of it by chance would seem to explain something.
  const auto equation = std::move(MakeEquations("hunt_crossley").front());
  double law = 0.0;
  for (const unsigned seed : {11U, 12U, 13U, 14U, 15U}) {
    Recording recording = ShortTaps(6000, 0.03, seed);
    const Vector &x = recording.Column("x"), more = test::Noise(x.size(), seed + 100);
    recording.columns.back() += (x.array() > 0.0).select(0.1 * more, 0.0);
    const Diagnosis diagnosis = Diagnose(*equation, recording);
    ASSERT_EQ(diagnosis.finding.verdict, Verdict::kNone);
    for (const CandidatePtr& candidate : diagnosis.finding.tried)
      if (candidate->fit.hypothesis.terms.back().form->regular) law += candidate->probability;
  }
  EXPECT_LT(law / 5.0, 0.1);
}

TEST(WeakEffects, EventsThatNoEffectExplainsAreNotNothing) {
  // A limit that only the deepest tap reaches, and that the catalogue lacks.
  const Made made = Measure({}, 6000, 0.05, 31);
  const double limit = 0.95 * made.clean.maxCoeff();
  Vector f = made.recording.Column("f");
  f.array() -= (made.clean.array() - limit).max(0.0);
  const auto equation = std::move(MakeEquations("hunt_crossley").front());
  DiagnoseOptions options;
  options.without = {"sensor_saturation"};
  const Recording clipped =
      test::MakeRecording(made.recording.Column("t"), made.recording.Column("x"), made.recording.Column("v"), f);
  const Finding finding = Diagnose(*equation, clipped, options).finding;
  EXPECT_EQ(finding.verdict, Verdict::kUnnamed);
  EXPECT_GE(finding.events_s.size(), 1U);
  double total = 1.0 - finding.p_missing * (1.0 - finding.p_unnamed);
  for (const CandidatePtr& candidate : finding.tried) total += candidate->probability;
  EXPECT_NEAR(total, 1.0, 1e-9);
}

/// A bias of a tenth of the noise in what is diagnosed, and one of `rest` N in what is held out.
std::string NameWithRest(double rest) {
  const auto biased = [](double bias, unsigned seed) {
    HiddenEffect effect = test::Hidden("force_bias");
    effect.amplitude[0] = bias;
    return Measure({effect}, 12000, 0.1, seed).recording;
  };
  WorkflowRequest request;
  request.model = "hunt_crossley";
  request.data = biased(0.009, 51);
  request.heldout = biased(rest, 52);
  const Result result = RunWorkflow(request).result;
  return result.ladder.empty() ? "" : result.ladder.front().effects.front();
}

TEST(WeakEffects, ANameThatClosesNothingOnHeldOutDataIsTakenBack) {
  // The error with the bias is a third of a percent more or less there: all that such an effect can do.
  EXPECT_EQ(NameWithRest(0.009), "force_bias");
  EXPECT_EQ(NameWithRest(0.0), "");
}

TEST(Withdraw, WhatIsProbableButNotAdequateGivesWayToWhatHasNoName) {
  Finding finding;
  finding.verdict = Verdict::kNamed;
  finding.p_missing = 1.0;
  finding.p_unnamed = 0.1;
  for (const double probability : {0.81, 0.09}) {
    finding.tried.push_back(std::make_shared<Candidate>());
    finding.tried.back()->probability = probability;
  }
  finding.set = {finding.tried[1]};
  Withdraw(0.5, &finding);
  EXPECT_EQ(finding.verdict, Verdict::kUnnamed);
  EXPECT_TRUE(finding.set.empty());
  EXPECT_DOUBLE_EQ(finding.p_unnamed, 0.5);
  EXPECT_DOUBLE_EQ(finding.tried[0]->probability, 0.45);
  EXPECT_DOUBLE_EQ(finding.tried[1]->probability, 0.05);
  Withdraw(0.2, &finding);
  EXPECT_DOUBLE_EQ(finding.p_unnamed, 0.5) << "it is never made less probable";
}

}  // namespace
}  // namespace armcmc::gap::weak_effects_test
