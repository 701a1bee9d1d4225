// An error in the formula of the law: the flexible correction that is fitted beside an effect, and which effects are
// named nevertheless.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/workflow.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::law_error_test {
namespace {

using armcmc::test::HiddenEffect;

constexpr double kNoise = 0.02;  // N

/// A recording whose contact force is off by a smooth factor of depth and speed.
Recording OffBy(double share, const std::vector<HiddenEffect>& effects, int rows = 8000) {
  Recording with = test::Measure(effects, rows, kNoise, 21).recording;
  const Vector clean = test::Measure({}, rows, kNoise, 21).clean;
  const Vector x = with.Column("x"), v = with.Column("v");
  const double depth = x.maxCoeff(), speed = std::sqrt(v.squaredNorm() / static_cast<double>(v.size()));
  for (Eigen::Index i = 0; i < clean.size(); ++i)
    with.columns.back()[i] +=
        share * clean[i] *
        (std::cos(5.0 * x[i] / depth + 0.7 * v[i] / speed + 0.4) + std::sin(3.0 * x[i] / depth - 1.1 * v[i] / speed));
  return with;
}

const EffectForm* FormOf(const std::vector<EffectForm>& catalogue) {
  const auto it = std::find_if(catalogue.begin(), catalogue.end(), [](const EffectForm& f) { return f.regular; });
  return it == catalogue.end() ? nullptr : &*it;
}

TEST(LawError, BendsWithDepthAndSpeedAndIsNothingInTheAir) {
  const test::Bench bench(test::Measure({}, 4000, kNoise, 3).recording);
  const EffectForm* form = FormOf(bench.catalogue);
  ASSERT_NE(form, nullptr);
  EXPECT_FALSE(form->listed);
  const Fitter fitter(*bench.equation, bench.signals, test::White(kNoise));
  const Fitted base = bench.Base(fitter), with = fitter.Add(base, {form, {}});
  for (Eigen::Index i = 0; i < bench.signals.rows(); ++i)
    if (bench.signals.active[i] == 0.0) {
      ASSERT_EQ(with.predicted[i], 0.0);
    }
  // Of 25 bumps that nothing calls for a fit takes no more than their number of squares, times a chance of 5 sigma.
  EXPECT_LT(base.squares - with.squares, (25.0 + 5.0 * std::sqrt(50.0)) * kNoise * kNoise);
}

TEST(LawError, TakesWhatTheFormulaLacks) {
  const test::Bench bench(OffBy(0.03, {}));
  const Fitter fitter(*bench.equation, bench.signals, test::White(kNoise));
  const Fitted base = bench.Base(fitter), with = fitter.Add(base, {FormOf(bench.catalogue), {}});
  const double noise = kNoise * kNoise * static_cast<double>(bench.signals.rows());
  EXPECT_LT(with.squares - noise, 0.1 * (base.squares - noise));
}

TEST(LawError, CountsAsKnownWhereBlocksAreLeftOut) {
  const test::Bench bench(OffBy(0.03, {}));
  const Fitter fitter(*bench.equation, bench.signals, test::White(kNoise));
  const Fitted with = fitter.Add(bench.Base(fitter), {FormOf(bench.catalogue), {}});
  for (std::size_t i = 3; i < with.at_bound.size(); ++i) EXPECT_TRUE(with.at_bound[i]) << i;
  for (std::size_t i = 0; i < 3; ++i) EXPECT_FALSE(with.at_bound[i]) << i;
}

TEST(LawError, IsMoreProbableThanAnEffectWhereItIsTooSmallToBeReported) {
  const auto equation = std::move(MakeEquations("hunt_crossley").front());
  const Diagnosis diagnosis = Diagnose(*equation, OffBy(0.0008, {}, 5000));
  const Finding& finding = diagnosis.finding;
  ASSERT_EQ(finding.verdict, Verdict::kNone);
  EXPECT_LT(finding.p_none, 0.5);
  double total = finding.p_none;
  for (const CandidatePtr& candidate : finding.tried) {
    total += candidate->probability;
    if (!candidate->fit.hypothesis.terms.back().form->regular) {
      EXPECT_LT(candidate->probability, 0.3) << candidate->names().front();
    }
  }
  EXPECT_NEAR(total, 1.0, 1e-9);
}

TEST(LeastDecrease, IsWhatAnEffectTakesAtLeast) {
  const test::Bench bench(test::Measure({test::Hidden("coulomb_friction")}, 4000, kNoise, 3).recording);
  const Fitter fitter(*bench.equation, bench.signals, test::White(kNoise));
  const Fitted base = bench.Base(fitter);
  for (const char* name : {"coulomb_friction", "force_bias", "stress_relaxation"}) {
    const Term term{&bench.Form(name), {}};
    EXPECT_LE(fitter.LeastDecrease(base, term), 1.001 * (base.squares - fitter.Add(base, term).squares)) << name;
  }
  EXPECT_GT(fitter.LeastDecrease(base, {&bench.Form("coulomb_friction"), {}}),
            fitter.LeastDecrease(base, {&bench.Form("force_bias"), {}}));
}

TEST(FlexibleCorrection, AnEffectIsSureBesideALawThatIsNotQuiteItsFormula) {
  WorkflowRequest request;
  request.data = OffBy(0.03, {test::Hidden("force_bias")}, 5000);
  const Result result = RunWorkflow(request).result;
  // A second effect may stand for what the law errs by: then both are told, and the one of both is sure.
  ASSERT_FALSE(result.ladder.empty()) << result.sentence;
  EXPECT_EQ(result.ladder.front().effects, std::vector<std::string>{"force_bias"}) << result.sentence;
  EXPECT_EQ(result.effects.front().name, "force_bias");
  EXPECT_TRUE(result.effects.front().approximate);
  EXPECT_FALSE(result.complete);
}

TEST(FlexibleCorrection, IsRemovedFromTheVerdict) {
  const auto equation = std::move(MakeEquations("hunt_crossley").front());
  const Diagnosis diagnosis = Diagnose(*equation, OffBy(0.03, {test::Hidden("force_bias")}, 5000));
  const auto& set = diagnosis.finding.set;
  const auto with_correction =
      std::find_if(set.begin(), set.end(), [](const CandidatePtr& member) { return member->correction != nullptr; });
  ASSERT_NE(with_correction, set.end());
  const FlexibleCorrection& correction = *(*with_correction)->correction;
  EXPECT_EQ((*with_correction)->names(), std::vector<std::string>{"force_bias"});
  EXPECT_EQ((*with_correction)->fit.hypothesis.terms.size(), 1U);
  EXPECT_EQ(correction.with.hypothesis.terms.size(), 2U);
  EXPECT_EQ(correction.without.hypothesis.terms.size(), 1U);
  EXPECT_LT(correction.with.squares, (*with_correction)->fit.squares);
}

// A line of the sensor with an odd harmonic: together with the bias a bent law stands in for it, but takes less of it.
TEST(FlexibleCorrection, IsNotNeededWhereTheSecondEffectDoesBetter) {
  Recording recording = test::Measure({}, 6000, kNoise, 21).recording;
  for (Eigen::Index i = 0; i < recording.rows(); ++i) {
    const double phase = 2.0 * std::numbers::pi * 23.0 * recording.t[i];
    recording.columns.back()[i] += kNoise * (3.2 + 0.3 * std::sin(phase) + 0.2 * std::sin(3.0 * phase + 1.0));
  }
  const auto equation = std::move(MakeEquations("hunt_crossley").front());
  const Diagnosis diagnosis = Diagnose(*equation, recording);
  EXPECT_EQ(NamesOf(diagnosis.finding), (std::set<std::vector<std::string>>{{"force_bias", "periodic_disturbance"}}));
}

TEST(FlexibleCorrection, ALawThatIsOffByItselfGetsNoName) {
  WorkflowRequest request;
  request.data = OffBy(0.01, {}, 5000);
  const Result result = RunWorkflow(request).result;
  EXPECT_TRUE(result.effects.empty()) << result.sentence;
}

}  // namespace
}  // namespace armcmc::gap::law_error_test
