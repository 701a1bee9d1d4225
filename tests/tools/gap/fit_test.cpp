#include "armcmc/gap/fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::fit_test {
namespace {

using test::Bench;
using test::Hidden;
using test::Measure;
using test::White;

constexpr double kNoise = 0.1;  // N
constexpr int kRows = 4000;

void ExpectBase(const Bench& bench, const Fitted& fit, double variance) {
  const double truth[] = {4.0, 2.3, 1.7};
  const auto reported = bench.equation->Report(bench.signals, fit.theta, fit.Covariance(variance));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(reported[i].sd, 0.0);
    EXPECT_LT(std::abs(reported[i].mean - truth[i]), 4.0 * reported[i].sd)
        << reported[i].name << " = " << reported[i].mean << " +- " << reported[i].sd;
  }
}

TEST(Fitter, RecoversTheBaseLaw) {
  for (const unsigned seed : {1U, 2U}) {
    const Bench bench(Measure({}, kRows, kNoise, seed).recording);
    const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
    const Fitted fit = bench.Base(fitter);
    ExpectBase(bench, fit, kNoise * kNoise);
    EXPECT_NEAR(fit.squares / (kNoise * kNoise * kRows), 1.0, 4.0 * std::sqrt(2.0 / kRows));
    EXPECT_NEAR(fit.squares, fit.whitened_residual.squaredNorm(), 1e-9 * fit.squares);
    EXPECT_LT(-2.0 * fit.score(), fit.squares / (kNoise * kNoise) * 1.01) << "held out is a little worse, not more";
    EXPECT_GT(-2.0 * fit.score(), fit.squares / (kNoise * kNoise));
  }
}

TEST(Fitter, SpreadOfTheEstimatesIsWhatTheirSdSays) {
  constexpr int kSeeds = 40;
  Matrix z(kSeeds, 3);
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const Bench bench(Measure({}, 1500, kNoise, 100 + seed).recording);
    const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
    const Fitted fit = bench.Base(fitter);
    const auto reported = bench.equation->Report(bench.signals, fit.theta, fit.Covariance(kNoise * kNoise));
    const double truth[] = {4.0, 2.3, 1.7};
    for (std::size_t i = 0; i < 3; ++i)
      z(seed, static_cast<Eigen::Index>(i)) = (reported[i].mean - truth[i]) / reported[i].sd;
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(z.col(i).mean()), 4.0 / std::sqrt(kSeeds)) << i;
    EXPECT_NEAR(z.col(i).squaredNorm() / kSeeds, 1.0, 4.0 * std::sqrt(2.0 / kSeeds)) << i;
  }
}

class FitterRecovers : public ::testing::TestWithParam<armcmc::test::HiddenEffect> {};

TEST_P(FitterRecovers, TheEffectAndTheBase) {
  const auto& truth = GetParam();
  Recording recording = Measure({truth}, kRows, kNoise, 3).recording;
  if (truth.name == "inertia") {
    // The reference's difference is half a sample late, which would show: the acceleration of the motion itself.
    recording = Measure({}, kRows, kNoise, 3).recording;
    const Eigen::ArrayXd t = recording.t.array();
    recording.columns[3].array() -=
        truth.amplitude[0] * (0.5 * 3.1 * 3.1 * (3.1 * t - 0.4).sin() + 0.3 * 7.3 * 7.3 * (7.3 * t).sin() +
                              0.12 * 17.9 * 17.9 * (17.9 * t + 1.0).sin());
  }
  const Bench bench(recording);
  const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
  const EffectForm& form = bench.Form(truth.name);
  const Fitted fit = fitter.Add(bench.Base(fitter), {&form, {}});
  const double variance = kNoise * kNoise;
  EXPECT_NEAR(fit.squares / (variance * kRows), 1.0, 4.0 * std::sqrt(2.0 / kRows));
  // The recording's drifts count from its start, the reference's from the shape: K and the zero differ by that alone.
  if (truth.name != "stiffness_drift" && truth.name != "force_drift") ExpectBase(bench, fit, variance);
  const Matrix covariance = fit.Covariance(variance);
  std::vector<double> values = truth.amplitude;
  if (form.size() > static_cast<int>(values.size())) values.push_back(truth.shape.at(0));
  if (truth.name == "stiffness_drift") values[0] /= 1.0 - values[0] * truth.shape[0];
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(3 + i);
    const Coordinate& c = fit.coordinates[static_cast<std::size_t>(k)];
    const double sd = std::abs(c.Slope(fit.theta[k])) * std::sqrt(covariance(k, k));
    EXPECT_GT(sd, 0.0) << c.name;
    EXPECT_LT(std::abs(c.Value(fit.theta[k]) - values[i]), 4.0 * sd)
        << c.name << " = " << c.Value(fit.theta[k]) << " +- " << sd << ", truth " << values[i];
  }
}

std::vector<armcmc::test::HiddenEffect> Recoverable() {
  std::vector<armcmc::test::HiddenEffect> all = armcmc::test::Catalogue();
  // From the start of the recording: a drift from another origin is a drift and a bias.
  for (auto& effect : all)
    if (effect.name == "force_drift") effect.shape[0] = 0.0;
  return all;
}

INSTANTIATE_TEST_SUITE_P(Catalogue, FitterRecovers, ::testing::ValuesIn(Recoverable()),
                         [](const auto& at) { return at.param.name; });

TEST(Fitter, AnAmplitudeThatPhysicsForbidsRestsAtItsBound) {
  // Friction that pushes: the sign is impossible.
  const Bench bench(Measure({{"viscous_friction", {-0.5}, {}}}, kRows, kNoise, 3).recording);
  const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
  const Fitted base = bench.Base(fitter);
  for (const char* name : {"viscous_friction", "coulomb_friction"}) {
    const Fitted fit = fitter.Add(base, {&bench.Form(name), {}});
    EXPECT_EQ(fit.theta[3], 0.0) << name;
    EXPECT_TRUE(fit.at_bound[3]) << name;
    EXPECT_EQ(fit.Covariance(1.0)(3, 3), 0.0);
    EXPECT_TRUE(std::isfinite(fit.log_evidence));
    EXPECT_TRUE(fit.heldout.allFinite());
    EXPECT_NEAR(fit.score(), base.score(), 1e-3 * std::abs(base.score())) << "it says nothing more than the base";
  }
}

/// A relaxation whose memory of the time before the recording is pushed to its bound, of a contact that is at first
/// `depth` deep.
Fitted WithMemoryAtItsBound(double depth) {
  armcmc::test::Series series(kRows);
  series.dt = 1e-3;
  for (int n = 0; n < kRows; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const double s = series.dt * n;
    series.t[i] = s;
    series.x[i] = depth + 0.6 * std::sin(3.1 * s) + 0.3 * std::sin(7.3 * s);
    series.v[i] = 0.6 * 3.1 * std::cos(3.1 * s) + 0.3 * 7.3 * std::cos(7.3 * s);
  }
  armcmc::test::Simulate({Hidden("stress_relaxation")}, &series);
  const Bench bench(test::RecordingOf(series, kNoise, 3));
  const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
  Fitted fit = fitter.Add(bench.Base(fitter), {&bench.Form("stress_relaxation"), {}});
  const auto memory = std::find_if(fit.coordinates.begin(), fit.coordinates.end(),
                                   [](const Coordinate& c) { return c.name == "start"; });
  fit.theta[memory - fit.coordinates.begin()] = memory->upper;
  return fit;
}

TEST(Fitter, ABoundThatTheDataDoNotFeelMakesNoOtherEffect) {
  // A contact that begins at the surface remembers nothing: any memory of the time before predicts the same.
  EXPECT_FALSE(WithMemoryAtItsBound(0.0).on_edge());
  EXPECT_TRUE(WithMemoryAtItsBound(0.4).on_edge());
}

// Adhesion jumps where the contact ends: a sample that noise moves past the surface would be wrong by the whole jump.
TEST(Fitter, TheForceSaysOnWhichSideOfTheSurfaceASampleLies) {
  constexpr int kMany = 20'000;
  constexpr double kLittleNoise = 0.02, kPositionNoise = 5e-4;
  Recording recording = Measure({Hidden("adhesion")}, kMany, kLittleNoise, 3).recording;
  const Vector truth = recording.Column("x");
  recording.columns[1] += kPositionNoise * test::Noise(kMany, 9);
  const Bench bench(recording);
  const Vector& settled = bench.signals.at(Role::kPosition);
  int wrong = 0, hidden = 0;
  for (Eigen::Index i = 0; i < kMany; ++i) {
    if (recording.Column("v")[i] > 0.0) continue;  // nothing jumps on the way in
    wrong += (settled[i] >= 0.0) != (truth[i] >= 0.0) ? 1 : 0;
    hidden += std::abs(truth[i]) < 0.2 * kPositionNoise ? 1 : 0;
  }
  EXPECT_GT(hidden, 0) << "no sample is near enough to the surface to show anything";
  EXPECT_EQ(wrong, 0);
  const Fitter fitter(*bench.equation, bench.signals, White(kLittleNoise));
  const Fitted fit = fitter.Add(bench.Base(fitter), {&bench.Form("adhesion"), {}});
  EXPECT_LT(fit.whitened_residual.cwiseAbs().maxCoeff(), 8.0 * kLittleNoise);
}

// Only the first samples know what a branch remembers of the time before the recording. Were that left out with them,
// the physics itself would score worse than a formula that has no such state.
TEST(Fitter, AStateAtTheStartIsTakenAsKnown) {
  const armcmc::test::HiddenEffect forgetful{"stress_relaxation", {8.0}, {0.02}};  // within the first block
  const test::Made longer = Measure({forgetful}, 300 + kRows, kNoise, 3);
  const Bench bench(longer.recording.Slice(300, kRows));  // begins in the middle of a press
  const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
  const Fitted base = bench.Base(fitter);
  const Fitted fit = fitter.Add(base, {&bench.Form("stress_relaxation"), {}});
  const Fitted stateless = fitter.Add(base, {&bench.Form("stress_relaxation", "two_time_constants"), {}});
  EXPECT_GT(fit.score(), stateless.score());
  EXPECT_NEAR(fit.score(), -0.5 * fit.squares / fitter.whitener().variance,
              3.0 * static_cast<double>(fit.theta.size()));
  const auto start = std::find_if(fit.coordinates.begin(), fit.coordinates.end(),
                                  [](const Coordinate& c) { return c.name == "start"; });
  const auto k = static_cast<Eigen::Index>(start - fit.coordinates.begin());
  EXPECT_GT(fit.Covariance(fitter.whitener().variance)(k, k), 0.0) << "fitted, so not exactly known";
}

TEST(Fitter, NeitherOfTwoBranchesForgetsSoonerThanOneAlone) {
  const Bench bench(Measure({}, kRows, kNoise, 3).recording);
  const EffectForm& two = bench.Form("stress_relaxation", "two_time_constants");
  const Coordinate& tau = two.coordinates[2];
  ASSERT_EQ(tau.name, "time_constant");
  const double shape[] = {tau.lower, std::log(16.0)};
  const Vector depth = bench.signals.at(Role::kPosition).cwiseMax(0.0);
  const Vector fast = two.filter(bench.signals, depth, 0, shape), slow = two.filter(bench.signals, depth, 1, shape);
  EXPECT_LT((fast - slow).norm(), 1e-9 * slow.norm()) << "a branch without memory is a damping";
}

/// A delay, fitted to a force that comes so many samples late.
Fitted WithDelay(double samples, const char* effect) {
  constexpr double kLittleNoise = 1e-3;
  test::Made made = Measure({}, kRows, 0.0, 3);
  const Vector& f = made.clean;
  Vector late = f;
  late.tail(kRows - 1) += samples * (f.head(kRows - 1) - f.tail(kRows - 1));
  made.recording.columns[3] = late + kLittleNoise * test::Noise(kRows, 4);
  const Bench bench(made.recording);
  const Fitter fitter(*bench.equation, bench.signals, White(kLittleNoise));
  return fitter.Add(bench.Base(fitter), {&bench.Form(effect), {}});
}

TEST(Fitter, AWidthThatOneReversalTellsIsNoReasonToRejectAFriction) {
  // In and out again at constant speed: the width shows around the one reversal, and nothing else knows it.
  constexpr int kRamp = 8000, kReversal = 5100;  // in the middle of a block
  constexpr double kSpeed = 0.1, kRounding = 0.02, kWidth = 0.03, kFriction = 0.15, kSpeedNoise = 0.002;
  const Vector t = Vector::LinSpaced(kRamp, 0.0, 1e-3 * (kRamp - 1));
  const Eigen::ArrayXd since = (t.array() - 1e-3 * kReversal) / kRounding;
  const Vector v = -kSpeed * since.tanh();
  const Vector x = 0.4 - kSpeed * kRounding * (since.abs() + (1.0 + (-2.0 * since.abs()).exp()).log());
  const Eigen::ArrayXd inside = x.array().max(0.0);
  const Vector f = inside.pow(1.7) * (4.0 + 2.3 * v.array()) + kFriction * (v.array() / kWidth).tanh();
  const Vector seen = v + kSpeedNoise * test::Noise(kRamp, 9);
  const Bench bench(test::MakeRecording(t, x, seen, f + kNoise * test::Noise(kRamp, 7)));
  const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
  const Fitted base = bench.Base(fitter);
  const Fitted dry = fitter.Add(base, {&bench.Form("coulomb_friction"), {}});
  const Fitted viscous = fitter.Add(base, {&bench.Form("viscous_friction"), {}});
  EXPECT_GT(dry.score(), base.score() + 100.0);
  EXPECT_GT(dry.score(), viscous.score());
}

TEST(Fitter, ALatencyBelowATenthOfASampleIsNone) {
  for (const char* effect : {"sensor_delay", "sensor_lag"}) {
    for (const double samples : {0.02, 0.08}) {
      const Fitted fit = WithDelay(samples, effect);
      EXPECT_TRUE(fit.on_edge()) << effect << " of " << samples << " samples = " << fit.theta[3];
    }
    const Fitted longer = WithDelay(0.5, effect);
    EXPECT_FALSE(longer.on_edge()) << effect;
    EXPECT_NEAR(longer.coordinates[3].Value(longer.theta[3]), 0.5e-3, 0.05e-3) << effect;
  }
}

TEST(Fitter, ALagMayBeLongerThanTheMotionTakesToChange) {
  armcmc::test::HiddenEffect hidden = Hidden("sensor_lag");
  hidden.amplitude[0] = 0.15;  // s; the speed changes by its own size within 0.08 s
  const Bench bench(Measure({hidden}, kRows, kNoise, 3).recording);
  const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
  const Fitted fit = fitter.Add(bench.Base(fitter), {&bench.Form("sensor_lag"), {}});
  EXPECT_NEAR(fit.coordinates[3].Value(fit.theta[3]), hidden.amplitude[0], 0.003);
  EXPECT_NEAR(fit.squares / (kNoise * kNoise * kRows), 1.0, 5.0 * std::sqrt(2.0 / kRows));
}

TEST(Fitter, KeepsEveryCoordinateInsideItsBounds) {
  // Data that no contact made: the fit goes to the edges and stays there.
  Recording recording = Measure({}, 1500, kNoise, 3).recording;
  recording.columns[3] = 40.0 * test::Noise(1500, 8);
  const Bench bench(recording);
  const Fitter fitter(*bench.equation, bench.signals, White(40.0));
  const Fitted base = bench.Base(fitter);
  for (const EffectForm& form : bench.catalogue) {
    const Fitted fit = fitter.Add(base, {&form, {}});
    ASSERT_TRUE(fit.theta.allFinite()) << form.effect << form.variant;
    for (std::size_t i = 0; i < fit.coordinates.size(); ++i) {
      EXPECT_GE(fit.theta[static_cast<Eigen::Index>(i)], fit.coordinates[i].lower) << form.effect << form.variant;
      EXPECT_LE(fit.theta[static_cast<Eigen::Index>(i)], fit.coordinates[i].upper) << form.effect << form.variant;
    }
    EXPECT_LE(fit.squares, base.squares * (1.0 + 1e-9)) << form.effect << form.variant;
    EXPECT_TRUE(std::isfinite(fit.score())) << form.effect << form.variant;
    EXPECT_TRUE(std::isfinite(fit.log_evidence)) << form.effect << form.variant;
  }
}

TEST(Fitter, CorrelatedNoiseIsWhitened) {
  const Vector phi{{0.8}};
  Recording recording = Measure({Hidden("coulomb_friction")}, kRows, 0.0, 3).recording;
  const Whitener whitener{phi, 0.01};
  recording.columns[3] += whitener.Colour(0.1 * test::Noise(kRows, 21));
  const Bench bench(recording);
  const Fitter fitter(*bench.equation, bench.signals, whitener);
  const Fitted fit = fitter.Add(bench.Base(fitter), {&bench.Form("coulomb_friction"), {}});
  ExpectBase(bench, fit, whitener.variance);
  EXPECT_NEAR(fit.squares / (0.01 * kRows), 1.0, 4.0 * std::sqrt(2.0 / kRows));
  const double sd = std::sqrt(fit.Covariance(whitener.variance)(3, 3)) * fit.coordinates[3].unit_size;
  EXPECT_LT(std::abs(fit.coordinates[3].Value(fit.theta[3]) - 0.6), 4.0 * sd);
}

TEST(Fitter, AnOverParametrisedHypothesisDoesNotBreak) {
  // Every effect twice explains nothing more; the normal equations are singular.
  const Bench bench(Measure({Hidden("force_bias")}, 1500, kNoise, 3).recording);
  const Fitter fitter(*bench.equation, bench.signals, White(kNoise));
  const EffectForm& bias = bench.Form("force_bias");
  const Fitted one = fitter.Add(bench.Base(fitter), {&bias, {}});
  const Fitted two = fitter.Add(one, {&bias, {}});
  EXPECT_TRUE(two.theta.allFinite());
  EXPECT_TRUE(two.heldout.allFinite());
  EXPECT_NEAR(two.score(), one.score(), 1.0);
}

}  // namespace
}  // namespace armcmc::gap::fit_test
