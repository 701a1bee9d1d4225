// Smoothing, whitening and features: the arithmetic under the workflow.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "armcmc/gap/band_noise.hpp"
#include "armcmc/gap/features.hpp"
#include "armcmc/gap/smoothing.hpp"
#include "armcmc/gap/whitener.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::signal_tools_test {
namespace {

using test::Noise;

TEST(ElementaryFunctions, AreThoseOfTheLibraryWhateverTheCount) {
  for (const int rows : {0, 1, 15, 16, 17, 100}) {
    const Vector x = 3.0 * Noise(rows, 5), phase = 1e4 * x;
    for (int i = 0; i < rows; ++i) {
      EXPECT_NEAR(Exp(x)[i], std::exp(x[i]), 4e-15 * std::max(std::exp(x[i]), 1.0));
      EXPECT_NEAR(Tanh(x)[i], std::tanh(x[i]), 4e-15);
      EXPECT_NEAR(Sin(phase)[i], std::sin(phase[i]), 4e-15);
      EXPECT_NEAR(Cos(phase)[i], std::cos(phase[i]), 4e-15);
    }
  }
}

TEST(SavitzkyGolay, IsExactOnCubicsAtBothEndsToo) {
  for (const int rows : {9, 40, 201}) {
    const Vector i = Vector::LinSpaced(rows, 0.0, rows - 1.0);
    const Vector u = i / 10.0;
    const Vector cubic = 0.3 + 1.7 * u.array() - 0.4 * u.array().square() + 0.05 * u.array().cube();
    const Vector slope = 0.1 * (1.7 - 0.8 * u.array() + 0.15 * u.array().square());
    // Wider than the series: the whole of it is the window.
    for (const int window : {5, 7, 15, 41, 301}) {
      const double size = cubic.cwiseAbs().maxCoeff();
      EXPECT_LT((SavitzkyGolay(cubic, window, 0) - cubic).cwiseAbs().maxCoeff(), 1e-9 * size) << window;
      EXPECT_LT((SavitzkyGolay(cubic, window, 1) - slope).cwiseAbs().maxCoeff(), 1e-9 * size) << window;
    }
  }
}

TEST(SavitzkyGolay, HasNoPhaseAndTakesNoiseOff) {
  const Vector t = Vector::LinSpaced(4000, 0.0, 3.999);
  const Vector sine = (2.0 * std::numbers::pi * 3.0 * t.array()).sin();
  EXPECT_LT((SavitzkyGolay(sine, 15, 0) - sine).cwiseAbs().maxCoeff(), 1e-4);
  const Vector noise = Noise(4000, 2);
  EXPECT_LT(SavitzkyGolay(noise, 15, 0).norm(), 0.45 * noise.norm());
}

TEST(SavitzkyGolay, ANarrowWindowIsNone) {
  const Vector series = Noise(50, 1);
  for (const int window : {0, 1, 3}) EXPECT_EQ(SavitzkyGolay(series, window, 0), series);
  const Vector slope = SavitzkyGolay(Vector::LinSpaced(50, 0.0, 98.0), 3, 1);
  EXPECT_TRUE(slope.isApprox(Vector::Constant(50, 2.0), 1e-12));
}

TEST(Leaky, AnswersAStepExponentially) {
  Vector step = Vector::Ones(100);
  step[0] = 0.0;
  const Vector out = Leaky(step, 12.0);
  for (Eigen::Index n = 0; n < 100; ++n) EXPECT_NEAR(out[n], 1.0 - std::exp(-static_cast<double>(n) / 12.0), 1e-12);
  EXPECT_TRUE(Leaky(Vector::Constant(20, 3.0), 5.0).isApprox(Vector::Constant(20, 3.0), 1e-14)) << "it had settled";
  EXPECT_NEAR(Leaky(Vector::Constant(20, 3.0), 5.0, 0.0)[0], 3.0 * (1.0 - std::exp(-0.2)), 1e-12);
}

Vector Autoregressive(const Vector& phi, Eigen::Index rows, unsigned seed, double sd) {
  return Whitener{phi, sd * sd}.Colour(sd * Noise(rows, seed));
}

TEST(Whitener, ColourInvertsApply) {
  for (const Vector& phi : {Vector(), Vector{{0.95}}, Vector{{0.6, -0.3, 0.1}}}) {
    const Whitener whitener{phi, 1.0};
    const Vector series = Noise(500, 3);
    EXPECT_TRUE(whitener.Colour(whitener.Apply(series)).isApprox(series, 1e-12));
    EXPECT_TRUE(whitener.Apply(whitener.Colour(series)).isApprox(series, 1e-12));
    Matrix columns(500, 2);
    columns << series, Noise(500, 4);
    EXPECT_TRUE(whitener.Apply(columns).col(1).isApprox(whitener.Apply(Vector(columns.col(1))), 1e-14));
  }
}

// A recording begins in the middle of the noise: its first value varies as e does, not as w.
TEST(Whitener, TheFirstSamplesAreAsWhiteAsTheOthers) {
  for (const Vector& phi : {Vector{{0.95}}, Vector{{0.6, -0.3, 0.1}}, Vector{{1.2, -0.3}}}) {
    const Whitener whitener{phi, 1.0};
    constexpr int kRecordings = 4000;
    Vector squares = Vector::Zero(5);
    for (unsigned seed = 1; seed <= kRecordings; ++seed)
      squares += whitener.Apply(Vector(whitener.Colour(Noise(300, seed)).tail(20))).head(5).cwiseAbs2();
    for (Eigen::Index i = 0; i < 5; ++i)
      EXPECT_NEAR(squares[i] / kRecordings, 1.0, 4.0 * std::sqrt(2.0 / kRecordings)) << "sample " << i << " of " << phi;
  }
}

TEST(Whitener, GainIsTheVarianceOfTheNoiseOverThatOfItsSource) {
  EXPECT_DOUBLE_EQ((Whitener{Vector(), 2.0}).Gain(), 1.0);
  EXPECT_NEAR((Whitener{Vector{{0.9}}, 2.0}).Gain(), 1.0 / (1.0 - 0.81), 1e-9);
  const Vector phi{{0.6, -0.3}};
  const Vector series = Autoregressive(phi, 200'000, 5, 1.0);
  EXPECT_NEAR((Whitener{phi, 1.0}).Gain(), series.squaredNorm() / 200'000.0, 0.03);
}

TEST(FitNoise, RecoversTheCoefficients) {
  constexpr Eigen::Index kRows = 20'000;
  for (const Vector& phi : {Vector{{0.95}}, Vector{{0.6, -0.3}}, Vector{{0.0, 0.5, 0.3}}}) {
    const Whitener fitted = FitNoise(Autoregressive(phi, kRows, 1, 0.02));
    ASSERT_GE(fitted.phi.size(), phi.size());
    for (Eigen::Index k = 0; k < fitted.phi.size(); ++k)
      EXPECT_NEAR(fitted.phi[k], k < phi.size() ? phi[k] : 0.0, 4.0 / std::sqrt(kRows)) << "lag " << k + 1;
    EXPECT_NEAR(fitted.variance / 4e-4, 1.0, 4.0 * std::sqrt(2.0 / kRows));
  }
}

TEST(FitNoise, WhiteNoiseIsWhiteAndNothingIsNothing) {
  for (unsigned seed = 1; seed <= 20; ++seed) EXPECT_EQ(FitNoise(Noise(5000, seed)).phi.size(), 0) << seed;
  const Whitener silent = FitNoise(Vector::Zero(1000));
  EXPECT_GT(silent.variance, 0.0);
  EXPECT_TRUE(silent.phi.allFinite());
  EXPECT_TRUE(FitNoise(Vector::Constant(1000, 3.0)).phi.allFinite());
}

/// A sum of slow waves, up to a twentieth of the sampling rate.
Vector SlowWaves(Eigen::Index rows, double amplitude, double phase) {
  const Vector n = Vector::LinSpaced(rows, 0.0, static_cast<double>(rows) - 1.0);
  Vector sum = Vector::Zero(rows);
  for (const double period : {20.3, 33.7, 71.0, 150.0, 410.0})
    sum.array() += amplitude * (2.0 * std::numbers::pi / period * n.array() + phase * period).sin();
  return sum;
}

TEST(NoiseAboveBand, IsThatOfTheSensorWhateverTheLawErrsBy) {
  constexpr Eigen::Index kRows = 7000;
  const Vector law = SlowWaves(kRows, 1.0, 0.0);
  for (const Vector& phi : {Vector(), Vector{{0.4}}, Vector{{0.8}}, Vector{{-0.3}}, Vector{{0.9, -0.3}}}) {
    const Whitener truth{phi, 1e-4};
    for (const double misfit : {0.0, 0.1}) {
      const Vector residual = Autoregressive(phi, kRows, 3, 0.01) + SlowWaves(kRows, misfit, 0.3);
      const std::optional<Whitener> noise = NoiseAboveBand(residual, law);
      ASSERT_TRUE(noise);
      EXPECT_NEAR(noise->variance / truth.variance, 1.0, 0.15) << phi.transpose() << ", misfit " << misfit;
      EXPECT_NEAR(noise->variance * noise->Gain() / (truth.variance * truth.Gain()), 1.0, 0.35)
          << phi.transpose() << ", misfit " << misfit;
    }
    const Whitener all = FitNoise(Autoregressive(phi, kRows, 3, 0.01) + SlowWaves(kRows, 0.1, 0.3));
    EXPECT_GT(all.variance * all.Gain(), 5.0 * truth.variance * truth.Gain()) << "the misfit passes for noise";
  }
}

TEST(NoiseAboveBand, NeedsABandWithoutTheLaw) {
  EXPECT_FALSE(NoiseAboveBand(Noise(7000, 1), Noise(7000, 2))) << "the law is everywhere";
  EXPECT_FALSE(NoiseAboveBand(Noise(500, 1), Vector::Zero(500))) << "too short";
  EXPECT_TRUE(NoiseAboveBand(Noise(7000, 1), Vector::Zero(7000)));
}

TEST(Hats, SumToOneAndAreOneAtTheirKnot) {
  const Vector series = 3.0 * Noise(2000, 1);
  const Vector knots = QuantileKnots(series, Vector::Ones(2000), 9);
  ASSERT_EQ(knots.size(), 9);
  const Matrix hats = HatFunctions(series, knots);
  EXPECT_TRUE(hats.rowwise().sum().isApprox(Vector::Ones(2000), 1e-14));
  EXPECT_GE(hats.minCoeff(), 0.0);
  EXPECT_TRUE(HatFunctions(knots, knots).isApprox(Matrix::Identity(9, 9), 1e-14));
  // Linear between the knots, constant beyond the ends.
  const Vector clamped = series.cwiseMax(knots[0]).cwiseMin(knots[8]);
  EXPECT_TRUE((hats * knots).isApprox(clamped, 1e-13));
}

TEST(Hats, WithoutDataThereAreNoColumnsAndAConstantHasOne) {
  const Vector series = Noise(100, 1);
  const Vector none = QuantileKnots(series, Vector::Zero(100), 8);
  EXPECT_EQ(none.size(), 0);
  EXPECT_EQ(HatFunctions(series, none).rows(), 100);
  EXPECT_EQ(HatFunctions(series, none).cols(), 0);
  const Vector constant = Vector::Constant(100, 2.0);
  const Vector one = QuantileKnots(constant, Vector::Ones(100), 8);
  ASSERT_EQ(one.size(), 1);
  EXPECT_TRUE(HatFunctions(constant, one).isApprox(Vector::Ones(100)));
}

TEST(Bristle, BendsToItsLimitTurnsOverADistanceAndRestsInAHold) {
  constexpr double kDt = 1e-3, kDistance = 0.01;
  Vector v(3000);
  v.head(1000).setConstant(0.1);    // 10 distances
  v.segment(1000, 1000).setZero();  // a hold
  v.tail(1000).setConstant(-0.01);  // one distance back
  const Vector z = Bristle(v, kDistance, kDt);
  EXPECT_NEAR(z[0], 1.0 - std::exp(-0.1 * kDt / kDistance), 1e-12);
  EXPECT_NEAR(z[999], 1.0 - std::exp(-10.0), 1e-12);
  EXPECT_EQ(z[1999], z[999]);
  EXPECT_NEAR(z[2999], -1.0 + (z[999] + 1.0) * std::exp(-1.0), 1e-12);
  const Vector wild = Bristle(50.0 * Noise(5000, 3), kDistance, kDt);
  EXPECT_LE(wild.cwiseAbs().maxCoeff(), 1.0);
  EXPECT_TRUE(Bristle(Vector::Zero(10), kDistance, kDt).isZero(0.0));
}

TEST(StrongestLine, FindsASineOnAndBetweenTheBins) {
  constexpr Eigen::Index kRows = 10'007;  // a prime
  constexpr double kDt = 1e-3;
  const Vector t = Vector::LinSpaced(kRows, 0.0, kDt * (kRows - 1));
  for (const double frequency : {2.0, 9.9, 10.05, 37.123, 99.97, 180.0}) {
    const Vector sine = 0.2 * Waves(t, frequency, 1, 1).col(1);
    const Line line = StrongestLine(sine + Noise(kRows, 2), kDt);
    EXPECT_NEAR(line.frequency, frequency, 0.02) << "a fifth of a bin";
    EXPECT_GT(line.prominence, 40.0);
    EXPECT_NEAR(StrongestLine(sine, kDt).frequency, frequency, 0.01) << "without noise";
  }
}

TEST(StrongestLine, NoiseHasNone) {
  for (unsigned seed = 1; seed <= 20; ++seed) EXPECT_LT(StrongestLine(Noise(10'000, seed), 1e-3).prominence, 30.0);
  EXPECT_LT(StrongestLine(Vector::Zero(1000), 1e-3).prominence, 1.0);
  // Slower than ten cycles in the recording is a drift, faster than a fifth of the sampling rate is the sensor's.
  const Vector t = Vector::LinSpaced(10'000, 0.0, 9.999);
  for (const double frequency : {0.45, 230.0}) {
    const Line line = StrongestLine(Waves(t, frequency, 1, 1).col(0) + Noise(10'000, 1), 1e-3);
    EXPECT_GT(std::abs(line.frequency - frequency), 0.2);
  }
}

TEST(StrongestLine, AShortSeriesIsNoError) {
  for (const Eigen::Index rows : {1, 2, 5, 21, 64})
    EXPECT_TRUE(std::isfinite(StrongestLine(Noise(rows, 1), 1e-3).frequency)) << rows;
}

}  // namespace
}  // namespace armcmc::gap::signal_tools_test
