#include "armcmc/plant_sim/sensors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <vector>

namespace armcmc::plant_sim::sensors_test {
namespace {

constexpr int kSamples = 200'000;

/// Errors of the output channel while it truly is `level`.
std::vector<double> Errors(const NoiseLaw& law, double level, std::uint64_t seed = 3, int count = kSamples) {
  Sensors sensors({NoiseLaw{}, law}, seed);
  std::vector<double> errors;
  for (int i = 0; i < count; ++i) {
    PlantSample truth, measured;
    truth.output = level;
    truth.inputs[0] = 7.0;
    sensors.Measure(truth, &measured);
    EXPECT_EQ(measured.inputs[0], 7.0);
    errors.push_back(measured.output - level);
  }
  return errors;
}

double Covariance(const std::vector<double>& e, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t i = lag; i < e.size(); ++i) sum += e[i] * e[i - lag];
  return sum / static_cast<double>(e.size() - lag);
}

TEST(Sensors, ColourKeepsTheStandardDeviationAndDecaysGeometrically) {
  for (const NoiseKind kind : {NoiseKind::kGaussian, NoiseKind::kStudentT, NoiseKind::kLaplace, NoiseKind::kMixture}) {
    NoiseLaw law{kind, 0.5};
    law.dof = 10.0;
    law.correlation = 0.8;
    const std::vector<double> errors = Errors(law, 0.0);
    const double variance = Covariance(errors, 0), expected = NoiseSd(law) * NoiseSd(law);
    // Four standard errors of a variance from n (1 - r^2) / (1 + r^2) independent draws; mixtures have heavier tails.
    EXPECT_NEAR(variance, expected, 0.06 * expected) << NoiseKindName(kind);
    EXPECT_NEAR(Covariance(errors, 1) / variance, 0.8, 0.01) << NoiseKindName(kind);
    EXPECT_NEAR(Covariance(errors, 5) / variance, std::pow(0.8, 5), 0.02) << NoiseKindName(kind);
  }
}

TEST(Sensors, ColourIsThereFromTheFirstSample) {
  NoiseLaw law{NoiseKind::kGaussian, 1.0};
  law.correlation = 0.99;
  double sum = 0.0;
  constexpr int kRuns = 4000;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    Sensors sensors({law}, seed);
    PlantSample measured;
    sensors.Measure({}, &measured);
    sum += measured.output * measured.output;
  }
  EXPECT_NEAR(sum / kRuns, 1.0, 4.0 * std::sqrt(2.0 / kRuns));  // four standard errors
}

TEST(Sensors, WithoutColourAndGrowthTheDrawIsWhatItWas) {
  const NoiseLaw law{NoiseKind::kGaussian, 0.1};
  Rng rng(3, 1);
  for (const double error : Errors(law, 0.0)) ASSERT_EQ(error, Draw(law, &rng));
}

TEST(Sensors, NoiseGrowsWithTheSizeOfTheSignal) {
  NoiseLaw law{NoiseKind::kGaussian, 0.1};
  law.growth = 1.5;
  law.reference = 2.0;
  for (const double level : {0.0, 2.0, -4.0}) {
    const double sd = 0.1 * (1.0 + 1.5 * std::abs(level) / 2.0);
    EXPECT_NEAR(std::sqrt(Covariance(Errors(law, level), 0)), sd, 4.0 * sd / std::sqrt(2.0 * kSamples)) << level;
  }
}

TEST(Sensors, ChannelsAreIndependent) {
  NoiseLaw law{NoiseKind::kGaussian, 1.0};
  law.correlation = 0.5;
  Sensors sensors({law, law}, 1);
  double product = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    PlantSample measured;
    sensors.Measure({}, &measured);
    product += measured.inputs[0] * measured.output;
  }
  EXPECT_LT(std::abs(product) / kSamples, 4.0 * std::sqrt(5.0 / 3.0 / kSamples));  // (1 + r^2) / (1 - r^2) = 5/3
}

TEST(Sensors, RecordedNoiseIsPlayedForthAndBackFromAPlaceThatTheSeedDraws) {
  const auto series = std::make_shared<Series>();
  for (int i = 0; i < 1000; ++i) series->values.push_back(i);
  NoiseLaw law{NoiseKind::kRecorded, 0.5};
  law.recording = series;
  std::set<double> starts;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const std::vector<double> errors = Errors(law, 3.0, seed, 4000);
    starts.insert(errors.front());
    int turns = 0;
    double step = errors[1] - errors[0];
    for (std::size_t i = 1; i < errors.size(); ++i) {
      const double end = step > 0.0 ? 499.5 : 0.0;
      const bool turn = std::abs(errors[i - 1] - end) < 1e-9;
      ASSERT_NEAR(errors[i] - errors[i - 1], turn ? 0.0 : step, 1e-9) << i;
      if (!turn) continue;
      step = -step;
      ++turns;
    }
    EXPECT_GE(turns, 3);
  }
  EXPECT_EQ(starts.size(), 5U);
}

}  // namespace
}  // namespace armcmc::plant_sim::sensors_test
