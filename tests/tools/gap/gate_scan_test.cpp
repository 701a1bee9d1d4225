#include "armcmc/gap/gate_scan.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>

#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::gate_scan_test {
namespace {

using test::Bench;
using test::Hidden;
using test::Measure;
using test::White;

constexpr double kNoise = 0.1;

/// Gain of the cut template, by least squares on all columns at once.
double BruteGain(const Fitted& parent, const Vector& cut) {
  if (cut.squaredNorm() == 0.0) return 0.0;
  Matrix columns(cut.size(), parent.theta.size() + 1);
  columns << parent.whitened_jacobian, cut;
  for (Eigen::Index c = 0; c < columns.cols(); ++c) columns.col(c).normalize();
  const Eigen::ColPivHouseholderQR<Matrix> base(columns.leftCols(parent.theta.size())), with(columns);
  const Vector& r = parent.whitened_residual;
  const Vector left = columns.leftCols(parent.theta.size()) * base.solve(r), both = columns * with.solve(r);
  return (r - left).squaredNorm() - (r - both).squaredNorm();
}

TEST(ScanGates, FindsWhatABruteForceScanFinds) {
  armcmc::test::HiddenEffect late = Hidden("force_bias");
  late.gate = EffectGate::kFrom;
  late.from_s = 0.6;
  const Bench bench(Measure({late}, 900, kNoise, 3).recording);
  const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
  const Fitted base = bench.Base(fitter);
  for (const char* name : {"force_bias", "viscous_friction", "stress_relaxation"}) {
    const EffectForm& form = bench.Form(name);
    const Vector c = Templates(fitter, base, form, nullptr).front();
    for (const GateCandidate& found : ScanGates(fitter, base, form, {c}, 1)) {
      const bool positive = form.coordinates[0].lower >= 0.0;
      const Vector own = c.cwiseProduct(GateOf(found.term.when, bench.signals));
      const double of_own = positive && own.dot(base.whitened_residual) <= 0.0 ? 0.0 : BruteGain(base, own);
      EXPECT_NEAR(found.gain, of_own, 1e-3 * of_own + 1e-9) << name << " " << TermText(found.term);
      if (found.term.when.kind != When::Kind::kFrom && found.term.when.kind != When::Kind::kUntil) continue;
      double best = 0.0;
      for (Eigen::Index i = 72; i < 900 - 72; ++i) {
        const Vector cut = c.cwiseProduct(GateOf({found.term.when.kind, bench.signals.t[i]}, bench.signals));
        // A sign that physics forbids gains nothing. The residual is orthogonal to the parent's columns.
        if (positive && cut.dot(base.whitened_residual) <= 0.0) continue;
        best = std::max(best, BruteGain(base, cut));
      }
      EXPECT_NEAR(found.gain, best, 1e-3 * best + 1e-9) << name << " " << TermText(found.term);
    }
  }
}

class Onset : public ::testing::TestWithParam<const char*> {};

TEST_P(Onset, IsFoundToAFewSamples) {
  for (const bool from : {true, false}) {
    armcmc::test::HiddenEffect gated = Hidden(GetParam());
    gated.gate = from ? EffectGate::kFrom : EffectGate::kUntil;
    gated.from_s = gated.until_s = 1.607;
    const Bench bench(Measure({gated}, 4000, 0.02, 3).recording);
    const Fitter fitter(*bench.equation, bench.signals, White(0.02));
    const Fitted base = bench.Base(fitter);
    const EffectForm& form = bench.Form(GetParam());
    const Fitted always = fitter.Add(base, {&form, {}});
    const auto gates = ScanGates(fitter, base, form, Templates(fitter, base, form, &always), 4);
    ASSERT_FALSE(gates.empty());
    EXPECT_EQ(gates[0].term.when.kind, from ? When::Kind::kFrom : When::Kind::kUntil);
    EXPECT_NEAR(gates[0].term.when.time_s, 1.607, 0.005);
    EXPECT_GT(gates[0].gain, gates[0].always_gain);
    const Fitted fit = fitter.Add(base, gates[0].term);
    EXPECT_LT(fit.squares, 1.2 * 0.02 * 0.02 * 4000) << "all of it is explained";
    EXPECT_NEAR(fit.coordinates[3].Value(fit.theta[3]), gated.amplitude[0], 0.05 * std::abs(gated.amplitude[0]));
  }
}

INSTANTIATE_TEST_SUITE_P(ScanGates, Onset, ::testing::Values("force_bias", "coulomb_friction"),
                         [](const auto& at) { return std::string(at.param); });

TEST(ScanGates, AnEffectThatIsSeenInFewBlocksHasNoGate) {
  const Bench bench(Measure({}, 2000, kNoise, 3).recording);
  const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
  const Fitted base = bench.Base(fitter);
  Vector once = Vector::Zero(2000);
  once.segment(1000, 60).setOnes();  // two blocks of 40
  for (const GateCandidate& gate : ScanGates(fitter, base, bench.Form("force_bias"), {once}, 4))
    ADD_FAILURE() << TermText(gate.term);
}

TEST(ScanGates, ATemplateOfTheParentGainsNothing) {
  const Bench bench(Measure({}, 2000, kNoise, 3).recording);
  const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
  const Fitted base = bench.Base(fitter);
  for (const GateCandidate& gate : ScanGates(fitter, base, bench.Form("force_bias"),
                                             {Vector(base.whitened_jacobian.col(0)), Vector::Zero(2000)}, 4)) {
    EXPECT_TRUE(std::isfinite(gate.gain));
    EXPECT_NEAR(gate.always_gain, 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace armcmc::gap::gate_scan_test
