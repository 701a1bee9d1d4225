// What a flexible model without a name still predicts, and where.

#include "armcmc/gap/adequacy_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/localise.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::adequacy_check_test {
namespace {

using test::Bench;
using test::Measure;
using test::White;

constexpr double kNoise = 0.1;  // N
constexpr int kRows = 6000;

/// A contact with something besides, as large as the noise times `ratio`, and the law fitted to it.
struct Lacking {
  Lacking(Vector lack, double ratio) : lack_(std::move(lack)) {
    const test::Made made = Measure({}, kRows, kNoise, 3);
    lack_ *= ratio * kNoise * std::sqrt(static_cast<double>(kRows)) / (lack_.norm() + 1e-300);
    Recording recording = made.recording;
    recording.columns[3] += lack_;
    bench = std::make_unique<Bench>(recording);
    fitter = std::make_unique<Fitter>(*bench->equation, bench->signals, White(kNoise));
    base = bench->Base(*fitter);
    adequacy_check = std::make_unique<AdequacyCheck>(*fitter, base.predicted);
  }
  /// Nats that it is worth beyond what the parameters of the law take of it.
  [[nodiscard]] double Explainable() const {
    const Matrix basis = OrthonormalBasis(base.whitened_jacobian);
    return 0.5 * (lack_ - basis * (basis.transpose() * lack_)).squaredNorm() / (kNoise * kNoise);
  }

  std::unique_ptr<Bench> bench;
  std::unique_ptr<Fitter> fitter;
  Fitted base;
  std::unique_ptr<AdequacyCheck> adequacy_check;

 private:
  Vector lack_;
};

TEST(AdequacyCheck, PredictsNothingOfNoise) {
  const Lacking nothing(Vector::Zero(kRows), 0.0);
  const Remainder left = nothing.adequacy_check->Judge(nothing.base);
  EXPECT_LT(left.total(), 10.0);
  EXPECT_EQ(left.line_frequency, 0.0);
}

TEST(AdequacyCheck, PredictsWhatTheLawLacksByTheVariableThatItDependsOn) {
  const Vector v = Measure({}, kRows, 0.0, 3).recording.Column("v");
  const Lacking drag(v.cwiseProduct(v.cwiseAbs()), 1.0);
  const double worth = drag.Explainable();
  ASSERT_GT(worth, 500.0);
  const double found = drag.adequacy_check->Judge(drag.base).total();
  EXPECT_GT(found, 0.8 * worth);
  EXPECT_LT(found, 1.05 * worth) << "no more than there is";
  const Matrix none(kRows, 0);
  EXPECT_GT(drag.adequacy_check->GainOf(drag.base, {"speed"}, none).sum(), 0.7 * worth);
  EXPECT_LT(drag.adequacy_check->GainOf(drag.base, {"time"}, none).sum(), 0.1 * worth);
}

TEST(AdequacyCheck, FindsASpectralLine) {
  const Vector t = Vector::LinSpaced(kRows, 0.0, 1e-3 * (kRows - 1));
  const Lacking hum((2.0 * std::numbers::pi * 31.0 * t.array()).sin(), 0.5);
  const Remainder left = hum.adequacy_check->Judge(hum.base);
  EXPECT_NEAR(left.line_frequency, 31.0, 0.1);
  EXPECT_GT(left.total(), 0.8 * hum.Explainable());
}

TEST(FindWhere, SaysInWhichModeTheErrorIsAndOnWhatItDepends) {
  armcmc::test::HiddenEffect friction = test::Hidden("coulomb_friction");
  friction.gate = EffectGate::kFree;
  const Bench bench(Measure({friction}, kRows, kNoise, 3).recording);
  const BlockBootstrap bootstrap(1);
  Analysis analysis;
  analysis.signals = bench.signals;
  analysis.catalogue = bench.catalogue;
  analysis.fitter = std::make_unique<Fitter>(*bench.equation, analysis.signals, White(kNoise));
  analysis.search = std::make_unique<Search>(*analysis.fitter, analysis.catalogue, bootstrap, Thresholds{},
                                             bench.Base(*analysis.fitter));
  analysis.finding.base = analysis.search->base();
  analysis.finding.gap = 1.0;
  const std::vector<Where> found = FindWhere(*bench.equation, analysis, bootstrap, 1);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().feature, "direction of motion");
  EXPECT_LT(found.front().p_value, 0.01);
  double in_free_motion = 0.0;
  for (const Where& where : found)
    if (where.feature == "region" && where.region.starts_with("in free motion"))
      in_free_motion += where.share_of_excess;
  EXPECT_GT(in_free_motion, 0.9);
}

}  // namespace
}  // namespace armcmc::gap::adequacy_check_test
