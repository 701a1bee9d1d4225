// Diagnosis and the held-out proof on recordings whose truth is known.

#include "armcmc/gap/verify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "armcmc/gap/workflow.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::verify_test {
namespace {

using test::Hidden;
using test::Measure;

constexpr double kNoise = 0.1;  // N
constexpr int kRows = 6000, kDiagnosed = 4200;

/// Friction, fitted to the first part of a recording. That it is the name needs no search here.
class HeldOutTest : public ::testing::Test {
 protected:
  HeldOutTest() {
    Analysis& analysis = *diagnosis_.wide;
    analysis.fitter = std::make_unique<Fitter>(*equation_, analysis.signals, test::White(kNoise));
    analysis.catalogue = equation_->Catalogue(analysis.signals);
    base_ = analysis.fitter->Fit({}, equation_->Start(analysis.signals), 30);
    const auto friction =
        std::find_if(analysis.catalogue.begin(), analysis.catalogue.end(),
                     [](const EffectForm& form) { return form.exact() && form.effect == "coulomb_friction"; });
    best_ = analysis.fitter->Add(base_, {&*friction, {}});
  }
  GapSummary Show(const Recording& shown, Eigen::Index first, const Fitted& after, const Fitted* control) const {
    const HeldOut data(*equation_, *diagnosis_.wide, shown, first);
    return ShowGap(*equation_, data, *diagnosis_.bootstrap, base_, after, control);
  }

  std::unique_ptr<Equation> equation_ = MakeEquation("hunt_crossley");
  Recording recording_ = Measure({Hidden("coulomb_friction")}, kRows, kNoise, 5).recording;
  Diagnosis diagnosis_ = CompareOnly(*equation_, recording_.Slice(0, kDiagnosed));
  Fitted base_, best_;
};

TEST_F(HeldOutTest, TheTrueModelClosesTheGap) {
  const GapSummary gap = Show(recording_, kDiagnosed, best_, &base_);
  EXPECT_EQ(gap.unit, "N");
  EXPECT_NEAR(gap.closed_fraction, 1.0, 0.02);
  EXPECT_LE(gap.closed_low, gap.closed_fraction);
  EXPECT_GE(gap.closed_high, gap.closed_fraction);
  EXPECT_NEAR(gap.after.rmse / kNoise, 1.0, 4.0 / std::sqrt(2.0 * (kRows - kDiagnosed)));
  EXPECT_NEAR(gap.noise_floor / kNoise, 1.0, 4.0 / std::sqrt(2.0 * (kRows - kDiagnosed)));
  EXPECT_LE(gap.noise_floor, gap.after.rmse);
  EXPECT_NEAR(gap.after.coverage95, 0.95, 4.0 * std::sqrt(0.95 * 0.05 / (kRows - kDiagnosed)));
  EXPECT_LT(gap.before.coverage95, 0.9);
  EXPECT_NEAR(gap.after.whiteness, 1.0, 4.0 * std::sqrt(2.0 / 25.0));
  EXPECT_GT(gap.before.whiteness, 5.0);
  EXPECT_NEAR(gap.gap_ratio * gap.noise_floor, std::sqrt(std::pow(gap.before.rmse, 2) - std::pow(gap.noise_floor, 2)),
              1e-9);
  ASSERT_EQ(gap.modes.size(), 2u);
  EXPECT_EQ(gap.modes[0].samples + gap.modes[1].samples, kRows - kDiagnosed);
  EXPECT_NEAR(gap.control_closed_fraction, 0.0, 1e-9) << "the control is the base model";
}

TEST_F(HeldOutTest, AnotherRunShowsTheSame) {
  const Recording other = Measure({Hidden("coulomb_friction")}, kRows, kNoise, 99).recording;
  EXPECT_NEAR(Show(other, 0, best_, nullptr).closed_fraction, 1.0, 0.02);
  // And a run of a plant without the effect says that the effect is not there.
  const Recording without = Measure({}, kRows, kNoise, 99).recording;
  const GapSummary gap = Show(without, 0, best_, nullptr);
  EXPECT_GT(gap.after.rmse, 1.5 * kNoise);
  EXPECT_GT(gap.after.rmse, gap.before.rmse);
}

TEST_F(HeldOutTest, WhatHappensInAFewStretchesIsPutAside) {
  Recording shown = recording_;
  shown.columns[3].segment(kDiagnosed + 200, 200).array() += 10.0 * kNoise;
  const HeldOut data(*equation_, *diagnosis_.wide, shown, kDiagnosed);
  EXPECT_GT(data.ClosedOutsideWorstBlocks(base_, best_), 0.97);
  EXPECT_EQ(data.ClosedOutsideWorstBlocks(base_, base_), 0.0);
}

TEST_F(HeldOutTest, AnEffectIsFoundBesideAnotherThatOnlyTheHeldOutDataShow) {
  const auto found = [&](const Recording& shown, Eigen::Index first) {
    return HeldOut(*equation_, *diagnosis_.wide, shown, first).FoundAsPredicted(base_, best_, *diagnosis_.bootstrap);
  };
  EXPECT_TRUE(found(recording_, kDiagnosed));
  // A spring that stiffens steeply, beyond what the exponent of the law absorbs.
  Recording stiffer = recording_;
  Vector& force = stiffer.columns[3];
  const Vector& depth = stiffer.columns[1];
  for (Eigen::Index n = kDiagnosed; n < kRows; ++n)
    if (depth[n] > 0.0) force[n] += 3.0 * kNoise * (std::exp(3.0 * depth[n] / depth.maxCoeff()) - 1.0);
  EXPECT_LT(Show(stiffer, kDiagnosed, best_, nullptr).closed_high, 0.5);
  EXPECT_TRUE(found(stiffer, kDiagnosed));
  EXPECT_FALSE(found(Measure({}, kRows, kNoise, 99).recording, 0));
}

TEST_F(HeldOutTest, AnEffectIsFoundBesideParametersThatAreFittedAgain) {
  const auto found = [&](const Recording& shown, Eigen::Index first, double least) {
    return HeldOut(*equation_, *diagnosis_.wide, shown, first)
        .FoundBesideLawError(base_, best_, *diagnosis_.bootstrap, least);
  };
  EXPECT_TRUE(found(recording_, kDiagnosed, 0.9));
  EXPECT_FALSE(found(recording_, kDiagnosed, 1.1)) << "no more than all of it";
  EXPECT_FALSE(found(Measure({}, kRows, kNoise, 99).recording, 0, 0.5)) << "it is not there";
  // A law that is another one in the rest, by as much as one that errs.
  Recording stiffer = recording_;
  stiffer.columns[3].tail(kRows - kDiagnosed) +=
      0.1 * Measure({}, kRows, 1e-9, 5).recording.columns[3].tail(kRows - kDiagnosed);
  EXPECT_TRUE(found(stiffer, kDiagnosed, 0.5));
}

TEST_F(HeldOutTest, AHeldOutPartWithoutContactIsNoError) {
  Recording air = recording_;
  air.columns[1].tail(kRows - kDiagnosed + 100).setConstant(-0.2);
  const GapSummary gap = Show(air, kDiagnosed, best_, nullptr);
  EXPECT_TRUE(std::isfinite(gap.noise_floor));
  EXPECT_TRUE(std::isfinite(gap.closed_fraction));
  EXPECT_EQ(gap.modes[0].samples, 0);
}

TEST_F(HeldOutTest, AHeldOutRunThatIsTooShortSaysSo) {
  for (const Eigen::Index rows : {2, 5, 20, 39}) {
    try {
      (void)Show(recording_.Slice(0, rows), 0, best_, nullptr);
      ADD_FAILURE() << rows << " rows were accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(std::to_string(rows) + " samples"), std::string::npos) << error.what();
    }
  }
}

// The same experiment in other units is the same experiment.
TEST(Units, DoNotChangeTheVerdict) {
  const Recording si = Measure({Hidden("stress_relaxation")}, 2500, kNoise, 7).recording;
  DiagnoseOptions options;
  options.pairs = false;
  const auto equation = std::move(MakeEquations("hunt_crossley").front());
  const Diagnosis reference = Diagnose(*equation, si, options);
  ASSERT_FALSE(reference.finding.set.empty());
  struct Case {
    const char* words;
    double length, force;
  };
  for (const Case& c : {Case{"millimetres", 1e3, 1.0}, Case{"millinewtons", 1.0, 1e3}}) {
    Recording scaled = si;
    scaled.columns[1] *= c.length;
    scaled.columns[2] *= c.length;
    scaled.columns[3] *= c.force;
    const Diagnosis other = Diagnose(*equation, scaled, options);
    EXPECT_EQ(other.finding.verdict, reference.finding.verdict) << c.words;
    ASSERT_EQ(other.finding.best->names(), reference.finding.best->names()) << c.words;
    ASSERT_EQ(other.finding.set.size(), reference.finding.set.size()) << c.words;
    EXPECT_NEAR(other.finding.gap, reference.finding.gap, 1e-4 * reference.finding.gap) << c.words;
    const Fitted& a = reference.finding.best->fit;
    const Fitted& b = other.finding.best->fit;
    EXPECT_LT((a.theta - b.theta).cwiseAbs().maxCoeff(), 1e-3) << c.words << ": coordinates are free of units";
    const auto first = equation->Report(reference.wide->signals, a.theta, Matrix::Zero(a.theta.size(), a.theta.size()));
    const auto second = equation->Report(other.wide->signals, b.theta, Matrix::Zero(b.theta.size(), b.theta.size()));
    EXPECT_NEAR(second[0].mean / (first[0].mean * c.force * std::pow(c.length, -first[2].mean)), 1.0, 1e-2) << c.words;
    EXPECT_NEAR(second[2].mean, first[2].mean, 1e-3) << c.words;
  }
}

/// The workflow on samples at another rate.
Result AtRate(double dt, int rows, bool hidden) {
  WorkflowRequest request;
  std::vector<armcmc::test::HiddenEffect> effects;
  if (hidden) effects.push_back(Hidden("force_bias"));
  request.data = Measure(effects, rows, kNoise, 5, dt).recording;
  request.diagnose.pairs = false;
  request.until = Step::kName;
  return RunWorkflow(request).result;
}

TEST(SampleRate, AHundredHertzAndTenKilohertzAreUnderstood) {
  for (const double dt : {1e-2, 1e-4}) {
    const int rows = dt > 1e-3 ? 1200 : 12'000;
    const Result none = AtRate(dt, rows, false), biased = AtRate(dt, rows, true);
    EXPECT_EQ(none.verdict, Verdict::kNone) << dt << " s: " << none.sentence;
    ASSERT_FALSE(biased.effects.empty()) << dt << " s: " << biased.sentence;
    EXPECT_EQ(biased.effects[0].name, "force_bias") << dt << " s: " << biased.sentence;
  }
}

TEST(Degenerate, DataThatSayNothingAreRefusedInWords) {
  const Recording good = Measure({}, 2000, kNoise, 5).recording;
  const auto refused = [&](const std::string& words, auto change) {
    WorkflowRequest request;
    request.data = good;
    change(&request.data);
    try {
      const Result result = RunWorkflow(request).result;
      ADD_FAILURE() << words << " was accepted: " << result.sentence;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("made.csv: "), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refused("does not move", [](Recording* r) { r->columns[1].setConstant(0.1); });
  refused("does not move", [](Recording* r) { r->columns[2].setConstant(0.3); });
  refused("does not move", [](Recording* r) { r->columns[2].setZero(); });
  refused("f does not change", [](Recording* r) { r->columns[3].setConstant(2.0); });
  refused("not positive", [](Recording* r) { r->columns[3].setZero(); });
  refused("samples", [](Recording* r) { *r = r->Slice(0, 300); });
}

TEST(Degenerate, WithoutContactTheLawIsNotJudged) {
  // A surface that is nowhere near where x says: forces without contact, which no effect of free motion makes.
  WorkflowRequest request;
  request.data = Measure({}, 2000, kNoise, 5).recording;
  request.data.columns[1].array() -= 50.0;
  const Result result = RunWorkflow(request).result;
  EXPECT_TRUE(result.effects.empty()) << result.sentence;
  EXPECT_TRUE(result.parameters.empty());
  ASSERT_FALSE(result.notes.empty());
  EXPECT_NE(result.notes[0].find("hardly any contact"), std::string::npos) << result.notes[0];
}

TEST(Degenerate, AModelWithoutAnyNoiseIsNotAccused) {
  WorkflowRequest request;
  request.data = Measure({}, 3000, 0.0, 5).recording;
  request.diagnose.pairs = false;
  const Result result = RunWorkflow(request).result;
  EXPECT_TRUE(result.effects.empty()) << result.sentence;
  EXPECT_TRUE(std::isfinite(result.gap.closed_fraction));
}

TEST(Degenerate, AlwaysInContactIsFine) {
  WorkflowRequest request;
  request.data = Measure({}, 3000, 0.0, 5).recording;
  Vector& x = request.data.columns[1];
  x.array() += 1.0;
  const Vector f = x.array().pow(1.7) * (4.0 + 2.3 * request.data.columns[2].array());
  request.data.columns[3] = f + kNoise * test::Noise(3000, 6);
  request.diagnose.pairs = false;
  const Result result = RunWorkflow(request).result;
  EXPECT_EQ(result.verdict, Verdict::kNone) << result.sentence;
}

}  // namespace
}  // namespace armcmc::gap::verify_test
