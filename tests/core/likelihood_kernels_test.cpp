#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <random>

#include "armcmc/data_pack.hpp"
#include "armcmc/mode_data.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/power_series.hpp"
#include "armcmc/settings.hpp"
#include "core/kernel_sets.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "plants/soft_actuator/constants.hpp"
#include "plants/soft_actuator/model.hpp"
#include "simd/kernels.hpp"
#include "support/same_bits.hpp"

namespace armcmc::likelihood_kernels_test {
namespace {

const int kHuntCrossley = FindModel("hunt_crossley");
const int kSoftActuator = FindModel("soft_actuator");

/// Samples, candidates and their predictions; large, so kept on the heap.
struct Batch {
  ModeData data;
  DataPack pack;
  ThetaTile theta;
  PredictionTile tile;
};

using test::Wide;

double Uniform(std::mt19937_64& g, double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(g); }

std::unique_ptr<Batch> ContactBatch(unsigned seed) {
  std::mt19937_64 g(seed);
  auto b = std::make_unique<Batch>();
  b->pack.num_samples = 237;
  for (std::size_t n = 0; n < 237; ++n) {
    b->pack.u[n] = {n % 7 == 3 ? -0.1 : std::exp(Uniform(g, -9.0, 0.7)), Uniform(g, -1.2, 1.2)};
    b->pack.y[n] = Uniform(g, -1.0, 12.0);
  }
  b->pack.u[11][0] = 0.0;
  HuntCrossley::Prepare(b->pack, {}, 0, &b->data);
  for (std::size_t l = 0; l < kTileLanes; ++l) {
    b->theta.value[0][l] = Uniform(g, 0.0, 8.0);
    b->theta.value[1][l] = Uniform(g, 0.0, 8.0);
    b->theta.value[2][l] = Uniform(g, 1.0, 2.5);
  }
  return b;
}

std::unique_ptr<Batch> ActuatorBatch(unsigned seed) {
  std::mt19937_64 g(seed);
  auto b = std::make_unique<Batch>();
  b->pack.num_samples = 100;
  for (std::size_t n = 0; n < 100; ++n) {
    const bool filling = n < 60;
    b->pack.u[n] = {filling ? 0.05 : 0.0, filling ? 0.0 : 0.05, Uniform(g, 102e3, 200e3), Uniform(g, -1e6, 1e6)};
  }
  SoftActuator::Prepare(b->pack, ActuatorConstants{}, 0, &b->data);
  for (std::size_t l = 0; l < kTileLanes; ++l) {
    b->theta.value[0][l] = Uniform(g, -5e-3, 5e-3);
    b->theta.value[1][l] = Uniform(g, -5e-8, 5e-8);
  }
  return b;
}

TEST(PredictKernel, ContactForceEqualsTheFormula) {
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    const auto b = ContactBatch(1);
    b->pack.u[12] = {1e-310, 0.1};  // subnormal; sample 11 is at touch
    HuntCrossley::Prepare(b->pack, {}, 0, &b->data);
    kernels->predict(kHuntCrossley, b->data, b->theta, &b->tile);
    std::size_t m = 0;
    for (std::size_t n = 0; n < 237; ++n) {
      const long double x = Wide(b->pack.u[n][0]), v = Wide(b->pack.u[n][1]);
      if (x < 0.0L) continue;
      for (std::size_t l = 0; l < kTileLanes; ++l) {
        const long double power = std::pow(x, Wide(b->theta.value[2][l]));
        const long double stiff = Wide(b->theta.value[0][l]), damped = Wide(b->theta.value[1][l]) * v;
        // The two terms may cancel: the error is relative to the larger one.
        const long double size = power * (std::fabs(stiff) + std::fabs(damped));
        ASSERT_NEAR(b->tile.value[m][l], static_cast<double>(power * (stiff + damped)),
                    static_cast<double>(1e-13L * size + 1e-300L))
            << kernels->name << " x " << static_cast<double>(x);
      }
      ++m;
    }
    EXPECT_EQ(static_cast<int>(m), b->data.num_samples);
  }
}

TEST(PredictKernel, ValveFlowEqualsTheFormula) {
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    const auto b = ActuatorBatch(2);
    ASSERT_EQ(b->data.num_samples, 60);
    kernels->predict(kSoftActuator, b->data, b->theta, &b->tile);
    for (std::size_t n = 0; n < 60; ++n)
      for (std::size_t l = 0; l < kTileLanes; ++l) {
        const long double pdot = Wide(b->pack.u[n][3]), over = Wide(b->pack.u[n][2]) - Wide(ActuatorConstants{}.p_atm);
        const long double a = pdot * Wide(b->theta.value[0][l]), c = pdot * over * Wide(b->theta.value[1][l]);
        ASSERT_NEAR(b->tile.value[n][l], static_cast<double>(a + c),
                    static_cast<double>(1e-13L * (std::fabs(a) + std::fabs(c))))
            << kernels->name;
      }
  }
}

NoiseSettings Noise(NoiseKind kind) {
  NoiseSettings s;
  s.kind = kind;
  s.mean = 0.03;
  s.dof = 3.5;
  s.outlier_weight = 0.08;
  s.outlier_scale = 12.0;
  return s;
}

TEST(LogLikelihoodKernel, EqualsTheSummedLogDensity) {
  for (const simd::Kernels* kernels : test::RunnableKernels())
    for (const NoiseKind kind : {NoiseKind::kGaussian, NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture})
      for (const int samples : {1, 7, 8, 9, 203}) {
        const auto b = ContactBatch(4);
        b->data.num_samples = samples;
        kernels->predict(kHuntCrossley, b->data, b->theta, &b->tile);
        alignas(64) double log_scale[kTileLanes] = {};
        alignas(64) double out[kTileLanes] = {};
        for (int l = 0; l < kTileLanes; ++l) log_scale[l] = -4.0 + 0.25 * l;  // scales from 0.02 to 40
        for (std::size_t n = 0; n < kMaxPackSamples; ++n) b->data.weight[n] = std::exp(-0.01 * static_cast<double>(n));
        const NoiseModel noise(Noise(kind));
        kernels->log_likelihood(noise, b->data, b->tile, log_scale, out);
        for (std::size_t l = 0; l < kTileLanes; ++l) {
          long double sum = 0.0L, size = 0.0L;
          for (std::size_t n = 0; n < static_cast<std::size_t>(samples); ++n) {
            const double e = (b->data.target[n] - b->tile.value[n][l] - noise.settings().mean) * b->data.weight[n];
            const double term = noise.LogDensity(e, std::exp(log_scale[l]));
            sum += Wide(term);
            size += Wide(std::fabs(term)) + 1.0L;
          }
          ASSERT_NEAR(out[l], static_cast<double>(sum), static_cast<double>(1e-13L * size))
              << kernels->name << " law " << static_cast<int>(kind) << " samples " << samples << " lane " << l;
        }
      }
}

TEST(LogLikelihoodKernel, FarOutliersStayFiniteUnderHeavyTails) {
  for (const simd::Kernels* kernels : test::RunnableKernels())
    for (const NoiseKind kind : {NoiseKind::kStudentT, NoiseKind::kMixture}) {
      const auto b = ContactBatch(5);
      for (std::size_t n = 0; n < 16; ++n) b->data.target[n] = 1e9;
      kernels->predict(kHuntCrossley, b->data, b->theta, &b->tile);
      b->data.weight.fill(1.0);
      alignas(64) double log_scale[kTileLanes] = {};
      alignas(64) double out[kTileLanes] = {};
      kernels->log_likelihood(NoiseModel(Noise(kind)), b->data, b->tile, log_scale, out);
      for (const double v : out) EXPECT_TRUE(std::isfinite(v)) << kernels->name;
    }
}

TEST(RelativeLikelihoodKernel, IsTheExponentialOfTheDifference) {
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    alignas(64) double value[64] = {}, out[64] = {};
    for (int k = 0; k < 64; ++k) value[k] = 1234.5 - 11.0 * k;
    kernels->relative_likelihood(value, 1234.5, 64, out);
    for (int k = 0; k < 64; ++k) {
      const double expected = std::exp(-11.0 * k);
      EXPECT_NEAR(out[k], expected, 1e-12 * expected + 1e-300) << kernels->name << " " << k;
    }
    value[0] = -HUGE_VAL;
    value[1] = std::nan("");
    kernels->relative_likelihood(value, 0.0, 8, out);
    EXPECT_LT(out[0], 1e-300);
    EXPECT_LT(out[1], 1e-300);
  }
}

TEST(RelativeLikelihoodKernel, ExponentialIsAccurateToTwoUnits) {
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    alignas(64) double value[1024] = {}, out[1024] = {};
    for (int k = 0; k < 1024; ++k) value[k] = -k / 1024.0;
    kernels->relative_likelihood(value, 0.0, 1024, out);
    for (int k = 0; k < 1024; ++k) {
      const double expected = static_cast<double>(std::exp(Wide(value[k])));
      EXPECT_NEAR(out[k], expected, 4.5e-16 * expected) << kernels->name << " " << value[k];
    }
  }
}

TEST(LogLikelihoodKernel, LogarithmIsAccurateToAFewUnits) {
  // One sample under the Cauchy law: log p = -log(1 + e^2) - log pi.
  NoiseSettings settings;
  settings.kind = NoiseKind::kStudentT;
  settings.dof = 1.0;
  const NoiseModel noise(settings);
  const auto b = ContactBatch(7);
  b->data.num_samples = 1;
  b->data.target[0] = 0.0;
  b->data.weight[0] = 1.0;
  for (const simd::Kernels* kernels : test::RunnableKernels())
    for (int block = 0; block < 32; ++block) {
      alignas(64) double log_scale[kTileLanes] = {}, out[kTileLanes] = {};
      for (std::size_t l = 0; l < kTileLanes; ++l) b->tile.value[0][l] = (block + static_cast<double>(l) / 32.0) / 16.0;
      kernels->log_likelihood(noise, b->data, b->tile, log_scale, out);
      for (std::size_t l = 0; l < kTileLanes; ++l) {
        const long double e = Wide(b->tile.value[0][l]);
        const double expected = static_cast<double>(Wide(noise.log_constant()) - std::log1p(e * e));
        EXPECT_NEAR(out[l], expected, 2e-15) << kernels->name << " " << static_cast<double>(e);
      }
    }
}

/// Scales of the noise, and the log-likelihood of predictions under them, to compare with.
struct Expected {
  NoiseModel noise;
  alignas(64) std::array<double, kTileLanes> log_scale{}, log_likelihood{};

  /// Sets the weights of the batch.
  Expected(const simd::Kernels& kernels, NoiseKind kind, bool weighted, Batch* b) : noise(Noise(kind)) {
    for (std::size_t n = 0; n < kMaxPackSamples; ++n)
      b->data.weight[n] = weighted ? std::exp(-0.01 * static_cast<double>(n)) : 1.0;
    b->data.weighted = weighted;
    for (std::size_t l = 0; l < kTileLanes; ++l) log_scale[l] = -3.0 + 0.1 * static_cast<double>(l);
    kernels.predict(kHuntCrossley, b->data, b->theta, &b->tile);
    kernels.log_likelihood(noise, b->data, b->tile, log_scale.data(), log_likelihood.data());
  }
};

TEST(ScoreKernel, EqualsPredictionAndLogLikelihood) {
  // Depths down to 0 and 1e-310: the scoring power and the exact one both have their turn.
  for (const simd::Kernels* kernels : test::RunnableKernels())
    for (const NoiseKind kind : {NoiseKind::kGaussian, NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture})
      for (const bool weighted : {false, true}) {
        const auto b = ContactBatch(8);
        b->pack.u[12][0] = 1e-310;
        HuntCrossley::Prepare(b->pack, {}, 0, &b->data);
        const Expected expected(*kernels, kind, weighted, b.get());
        alignas(64) double out[kTileLanes] = {};
        kernels->score(kHuntCrossley, expected.noise, b->data, b->theta, expected.log_scale.data(), &b->tile, out);
        for (std::size_t l = 0; l < kTileLanes; ++l)
          ASSERT_NEAR(out[l], expected.log_likelihood[l], 2e-10 * std::fabs(expected.log_likelihood[l]))
              << kernels->name << " law " << static_cast<int>(kind) << " weighted " << weighted;
      }
}

/// Exponents within `reach` of 1.75, and their powers.
std::unique_ptr<Batch> NearBatch(double reach, const simd::Kernels& kernels, PowerSeries* series) {
  auto b = ContactBatch(10);
  std::mt19937_64 g(11);
  for (double& p : b->theta.value[2]) p = 1.75 + Uniform(g, -reach, reach);
  b->theta.value[2][0] = 1.75 - reach;
  b->theta.value[2][1] = 1.75 + reach;
  b->data.weight.fill(1.0);
  std::array<double, kMaxParams> middle{}, reaches{};
  middle.fill(1.75);
  reaches.fill(reach);
  kernels.expand_power(kHuntCrossley, b->data, middle.data(), reaches.data(), series);
  return b;
}

TEST(ScoreNearKernel, EqualsPredictionAndLogLikelihood) {
  const auto series = std::make_unique<PowerSeries>();
  std::array<int, PowerSeries::kMost + 1> runs{};
  for (const simd::Kernels* kernels : test::RunnableKernels())
    for (const double reach : {0.0005, 0.003, 0.01, 0.03, 0.06, 0.1, 0.5})
      for (const NoiseKind kind : {NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture})
        for (const bool weighted : {false, true}) {
          const auto b = NearBatch(reach, *kernels, series.get());
          ASSERT_EQ(series->parameter, 2);
          for (int run = 0; run * PowerSeries::kRun < b->data.num_samples; ++run)
            ++runs[static_cast<std::size_t>(series->degree[static_cast<std::size_t>(run)])];
          const Expected expected(*kernels, kind, weighted, b.get());
          alignas(64) double out[kTileLanes] = {};
          kernels->score_near(kHuntCrossley, expected.noise, b->data, series.get(), b->theta, expected.log_scale.data(),
                              kTileLanes, out);
          for (std::size_t l = 0; l < kTileLanes; ++l)
            ASSERT_NEAR(out[l], expected.log_likelihood[l], 2e-10 * std::fabs(expected.log_likelihood[l]))
                << kernels->name << " law " << static_cast<int>(kind) << " reach " << reach << " lane " << l;
        }
  for (int degree = PowerSeries::kLeast; degree <= PowerSeries::kMost; ++degree)
    EXPECT_GT(runs[static_cast<std::size_t>(degree)], 0) << degree;
  EXPECT_GT(runs[0], 0);
}

TEST(ScoreNearKernel, WithoutSeriesGivesTheBitsOfTheScoreOfTheFirstLanes) {
  for (const simd::Kernels* kernels : test::RunnableKernels())
    for (const NoiseKind kind : {NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture})
      for (const int lanes : {1, 9, 16, 17, kTileLanes}) {
        const auto b = ContactBatch(12);
        alignas(64) double log_scale[kTileLanes] = {}, expected[kTileLanes] = {}, out[kTileLanes] = {};
        const NoiseModel noise(Noise(kind));
        kernels->score(kHuntCrossley, noise, b->data, b->theta, log_scale, &b->tile, expected);
        kernels->score_near(kHuntCrossley, noise, b->data, nullptr, b->theta, log_scale, lanes, out);
        for (int l = 0; l < lanes; ++l)
          EXPECT_EQ(out[l], expected[l]) << kernels->name << " law " << static_cast<int>(kind) << " lanes " << lanes;
      }
}

TEST(ScoreNearKernel, FusedInstructionSetsGiveTheSameBits) {
  const auto sets = test::FusedKernels();
  if (sets.size() < 2) GTEST_SKIP() << "this CPU runs one fused instruction set only";
  const auto series_a = std::make_unique<PowerSeries>(), series_b = std::make_unique<PowerSeries>();
  for (const double reach : {0.003, 0.03, 0.1})
    for (const NoiseKind kind : {NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture}) {
      const auto a = NearBatch(reach, *sets[0], series_a.get()), b = NearBatch(reach, *sets[1], series_b.get());
      alignas(64) double log_scale[kTileLanes] = {}, out_a[kTileLanes] = {}, out_b[kTileLanes] = {};
      const NoiseModel noise(Noise(kind));
      sets[0]->score_near(kHuntCrossley, noise, a->data, series_a.get(), a->theta, log_scale, kTileLanes, out_a);
      sets[1]->score_near(kHuntCrossley, noise, b->data, series_b.get(), b->theta, log_scale, kTileLanes, out_b);
      EXPECT_TRUE(test::SameBits(out_a, out_b)) << static_cast<int>(kind) << " reach " << reach;
    }
}

TEST(PowerSeries, IsOfNoUseForALawWithoutPowers) {
  const auto b = ActuatorBatch(3);
  const auto series = std::make_unique<PowerSeries>();
  const std::array<double, kMaxParams> numbers{};
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    series->parameter = 0;
    kernels->expand_power(kSoftActuator, b->data, numbers.data(), numbers.data(), series.get());
    EXPECT_EQ(series->parameter, -1) << kernels->name;
  }
}

TEST(ScoreKernel, MovesALogLikelihoodByLessThanAMillionth) {
  // Forces a hundred times the noise, residuals of its size: what a pack of the contact looks like near the mode.
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    const auto b = ContactBatch(9);
    for (std::size_t n = 0; n < 100; ++n) b->data.feature[0][n] = 0.008 * static_cast<double>(n);
    b->data.num_samples = 100;
    b->data.weight.fill(1.0);
    std::mt19937_64 g(10);
    for (auto& row : b->theta.value) row.fill(row[0]);
    for (std::size_t l = 0; l < kTileLanes; ++l) b->theta.value[2][l] += 1e-4 * Uniform(g, -1.0, 1.0);
    kernels->predict(kHuntCrossley, b->data, b->theta, &b->tile);
    for (std::size_t n = 0; n < 100; ++n) b->data.target[n] = b->tile.value[n][0] + Uniform(g, -0.1, 0.1);
    alignas(64) double log_scale[kTileLanes] = {}, expected[kTileLanes] = {}, out[kTileLanes] = {};
    for (double& s : log_scale) s = std::log(0.1);
    NoiseSettings settings;
    settings.std = 0.1;
    const NoiseModel noise(settings);
    kernels->log_likelihood(noise, b->data, b->tile, log_scale, expected);
    kernels->score(kHuntCrossley, noise, b->data, b->theta, log_scale, &b->tile, out);
    for (std::size_t l = 0; l < kTileLanes; ++l) ASSERT_NEAR(out[l], expected[l], 1e-6) << kernels->name;
  }
}

TEST(LikelihoodKernels, FusedInstructionSetsGiveTheSameBits) {
  const auto sets = test::FusedKernels();
  if (sets.size() < 2) GTEST_SKIP() << "this CPU runs one fused instruction set only";
  for (const NoiseKind kind : {NoiseKind::kGaussian, NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture}) {
    const NoiseModel noise(Noise(kind));
    const auto a = ContactBatch(6), b = ContactBatch(6);
    alignas(64) double log_scale[kTileLanes] = {}, out_a[kTileLanes] = {}, out_b[kTileLanes] = {};
    for (int l = 0; l < kTileLanes; ++l) log_scale[l] = -3.0 + 0.1 * l;
    a->data.weight.fill(1.0);
    b->data.weight.fill(1.0);
    sets[0]->predict(kHuntCrossley, a->data, a->theta, &a->tile);
    sets[1]->predict(kHuntCrossley, b->data, b->theta, &b->tile);
    const auto rows = static_cast<std::size_t>(a->data.num_samples);
    for (std::size_t n = 0; n < rows; ++n) EXPECT_TRUE(test::SameBits(a->tile.value[n], b->tile.value[n])) << n;
    sets[0]->log_likelihood(noise, a->data, a->tile, log_scale, out_a);
    sets[1]->log_likelihood(noise, b->data, b->tile, log_scale, out_b);
    EXPECT_TRUE(test::SameBits(out_a, out_b)) << static_cast<int>(kind);
    sets[0]->score(kHuntCrossley, noise, a->data, a->theta, log_scale, &a->tile, out_a);
    sets[1]->score(kHuntCrossley, noise, b->data, b->theta, log_scale, &b->tile, out_b);
    EXPECT_TRUE(test::SameBits(out_a, out_b)) << "score " << static_cast<int>(kind);
  }
}

}  // namespace
}  // namespace armcmc::likelihood_kernels_test
