// What is expected of a pack of a described plant before it was seen.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/plant/described_packs.hpp"
#include "core/plant/plants.hpp"

namespace armcmc::test::forecast_test {
namespace {

/// Pack of an axis whose force has a noise of 1 N.
DataPack AxisPack(const PlantProgram& plant, std::int64_t seq, GaussianNoise* noise) {
  return DescribedPack(plant, seq, [&](double t) {
    PlantSample s;
    s.u[0] = 0.1 * std::sin(7.0 * t) + 0.05 * std::sin(31.0 * t);
    s.u[1] = 0.7 * std::cos(7.0 * t) + 1.55 * std::cos(31.0 * t);
    s.y = 95.0 * s.u[1] + 210.0 * s.u[0] - 3.0 + (*noise)();
    return s;
  });
}

TEST(Forecast, IntervalsHoldWhatTheyPromise) {
  const auto plant = Program(DescribedAxis());
  Rig rig(DescribedSettings(plant));
  GaussianNoise noise(1.0);
  const auto forecast = std::make_unique<PackForecast>();
  double inside = 0.0, count = 0.0, square = 0.0;
  for (std::int64_t seq = 1; seq <= 40; ++seq) {
    (void)rig.estimator.Adjust(AxisPack(*plant, seq, &noise), 0, {}, rig.result.get());
    rig.estimator.Forecast(*rig.result, forecast.get());
    auto estimate = std::make_unique<Estimate>();
    rig.estimator.Execute(*rig.result, estimate.get());
    for (std::size_t n = 0; n < 100 && seq > 1; ++n) {
      const double error = forecast->target[n] - forecast->centre[n];
      ASSERT_TRUE(std::isfinite(error)) << "pack " << seq;
      inside += std::fabs(error) < 1.96 * std::hypot(forecast->sd[n], forecast->noise_std[n]) ? 1.0 : 0.0;
      square += error * error;
      count += 1.0;
    }
  }
  // 3900 samples: a binomial standard deviation of 0.35 %, and a little for parameters that are shared by many.
  EXPECT_NEAR(inside / count, 0.95, 0.015);
  EXPECT_NEAR(std::sqrt(square / count), 1.0, 0.05) << "the noise, when the parameters are known";
}

/// Runs of a contact that drifts for 4 s in touch, is in the air for 10 s, and comes back.
struct Returns {
  double inside = 0.0;  ///< Share of the samples where the expected interval holds what the law makes of the truth.
  double sd = 0.0;      ///< Mean of the standard deviations expected, N.
};
/// @param fastest  Speeds are spread evenly over [-fastest, fastest], in units of 0.1 N/m^p a second for K.
Returns ContactAfterAPause(int runs, double fastest, double drift_share) {
  const auto plant = Program(DescribedContact());
  EstimatorSettings settings = DescribedSettings(plant);
  settings.forgetting.drift_share = drift_share;
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = 1000;
  settings.gap_watch.enabled = false;
  GaussianNoise noise(0.1);
  const auto forecast = std::make_unique<PackForecast>();
  Returns sums;
  for (int run = 0; run < runs; ++run) {
    const double speed = fastest * (2.0 * (run + 0.5) / runs - 1.0);
    const auto force = [&](double t, double x, double v) {
      return std::pow(x, 1.7 + 0.01 * speed * t) * (4.0 + 0.1 * speed * t + (2.3 - 0.05 * speed * t) * v);
    };
    const auto pack = [&](std::int64_t seq, bool touches) {
      return DescribedPack(*plant, seq, [&](double t) {
        const double x = touches ? 1.0 + 0.5 * std::sin(8.2 * t) : -1.0, v = touches ? 4.1 * std::cos(8.2 * t) : 0.0;
        return PlantSample{{x, v}, (touches ? force(t, x, v) : 0.0) + noise()};
      });
    };
    Rig rig(settings);
    for (std::int64_t seq = 1; seq <= 40; ++seq) (void)rig.Step(pack(seq, true));
    (void)rig.Step(pack(41, false));
    const DataPack back = pack(140, true);
    (void)rig.estimator.Adjust(back, 0, {}, rig.result.get());
    rig.estimator.Forecast(*rig.result, forecast.get());
    for (std::size_t n = 0; n < 100; ++n) {
      const double t = back.t_last_s - (99.0 - static_cast<double>(n)) * 1e-3;
      const double error = force(t, back.u[n][0], back.u[n][1]) - forecast->centre[n];
      sums.inside += std::fabs(error) < 1.96 * forecast->sd[n] ? 0.01 / runs : 0.0;
      sums.sd += 0.01 * forecast->sd[n] / runs;
    }
  }
  return sums;
}

TEST(Forecast, GrowsByTheLearntDriftWhileNobodyLooks) {
  const Returns known = ContactAfterAPause(10, 1.5, ForgettingSettings{}.drift_share);
  const Returns denied = ContactAfterAPause(2, 1.5, 0.0);
  EXPECT_LT(denied.inside, 0.1) << "the drift is too slow to need it";
  EXPECT_GT(known.inside, 0.85);
  EXPECT_LT(known.sd, 2.0) << "of a force of up to 12 N";
}

TEST(Forecast, OfAPlantAtRestIsWhatItIsWithoutDrift) {
  const Returns rests = ContactAfterAPause(2, 0.0, ForgettingSettings{}.drift_share);
  const Returns denied = ContactAfterAPause(2, 0.0, 0.0);
  EXPECT_NEAR(rests.sd, denied.sd, 0.2 * denied.sd);
}

TEST(Forecast, DoesNotLookAtThePack) {
  const auto plant = Program(DescribedAxis());
  Rig one(DescribedSettings(plant)), other(DescribedSettings(plant));
  GaussianNoise noise(1.0);
  const auto first = std::make_unique<PackForecast>(), second = std::make_unique<PackForecast>();
  for (std::int64_t seq = 1; seq <= 3; ++seq) {
    const DataPack pack = AxisPack(*plant, seq, &noise);
    (void)one.Step(pack);
    (void)other.Step(pack);
  }
  DataPack pack = AxisPack(*plant, 4, &noise);
  (void)one.estimator.Adjust(pack, 0, {}, one.result.get());
  one.estimator.Forecast(*one.result, first.get());
  for (double& y : pack.y) y += 50.0;
  (void)other.estimator.Adjust(pack, 0, {}, other.result.get());
  other.estimator.Forecast(*other.result, second.get());
  for (std::size_t n = 0; n < 100; ++n) {
    EXPECT_TRUE(SameBits(first->centre[n], second->centre[n])) << n;
    EXPECT_TRUE(SameBits(first->sd[n], second->sd[n])) << n;
    EXPECT_DOUBLE_EQ(second->target[n] - first->target[n], 50.0);
  }
}

TEST(Forecast, IsUnknownBeforeAnythingWasLearnt) {
  const auto plant = Program(DescribedAxis());
  Rig rig(DescribedSettings(plant));
  GaussianNoise noise(1.0);
  const auto forecast = std::make_unique<PackForecast>();
  (void)rig.estimator.Adjust(AxisPack(*plant, 1, &noise), 0, {}, rig.result.get());
  rig.estimator.Forecast(*rig.result, forecast.get());
  EXPECT_EQ(forecast->num_samples, 100);
  EXPECT_TRUE(std::isnan(forecast->centre[0]));
}

}  // namespace
}  // namespace armcmc::test::forecast_test
