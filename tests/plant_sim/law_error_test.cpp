#include "armcmc/plant_sim/law_error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "armcmc/plant_sim/effects/gap_meter.hpp"
#include "armcmc/plant_sim/effects/hide.hpp"
#include "builtin_scenario.hpp"
#include "samples.hpp"

namespace armcmc::plant_sim::law_error_test {
namespace {

constexpr int kSeeds = 400;

Scenario WithError(const std::string& name, double share) {
  Scenario scenario = BuiltinScenario(name);
  scenario.duration_s = 3.0;
  scenario.options.Set("error", share);
  return scenario;
}

TEST(LawError, IsExactlyOneWhereTheLawIsTheFormula) { EXPECT_EQ(LawError(0.0, 7).Factor(0.3, -0.2), 1.0); }

TEST(LawError, ErrsByItsShareAndAnotherWayForEverySeed) {
  double sum_sq = 0.0, sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const double added = LawError(0.1, seed).Factor(0.6, -0.4) - 1.0;
    sum += added;
    sum_sq += added * added;
  }
  // Standard errors: 0.1 / sqrt(400) of the mean, at most 0.1 / sqrt(2 400) of the rms.
  EXPECT_NEAR(std::sqrt(sum_sq / kSeeds), 0.1, 4.0 * 0.1 / std::sqrt(2.0 * kSeeds));
  EXPECT_NEAR(sum / kSeeds, 0.0, 4.0 * 0.1 / std::sqrt(1.0 * kSeeds));
}

TEST(LawError, IsSmooth) {
  // Six waves no shorter than the range: |second derivative| <= share sqrt(2 / 6) 6 (2 pi)^2.
  const double steepest = 0.1 * std::sqrt(12.0) * std::pow(2.0 * 3.141592653589793, 2);
  constexpr double kStep = 1e-3;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const LawError error(0.1, seed);
    for (double a = 0.0; a < 1.0; a += 0.01) {
      const double bend = error.Factor(a + kStep, 0.1) - 2.0 * error.Factor(a, 0.1) + error.Factor(a - kStep, 0.1);
      ASSERT_LE(std::abs(bend), 1.001 * steepest * kStep * kStep) << seed;
    }
  }
}

TEST(LawError, OfAContactIsAShareOfTheForceAndNothingInTheAir) {
  const std::vector<PlantSample> exact = TrueSamples(WithError("contact_rich", 0.0), 3000);
  const std::vector<PlantSample> off = TrueSamples(WithError("contact_rich", 0.03), 3000);
  double most = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    ASSERT_EQ(off[i].inputs, exact[i].inputs);
    if (exact[i].mode != 0) {
      ASSERT_EQ(off[i].output, 0.0);
    } else {
      most = std::max(most, std::abs(off[i].output / exact[i].output - 1.0));
    }
  }
  EXPECT_GT(most, 0.003);
  EXPECT_LT(most, 0.03 * std::sqrt(12.0));
}

TEST(LawError, OfTheActuatorChangesHowFastThePressureRises) {
  const std::vector<PlantSample> exact = TrueSamples(WithError("soft_actuator_excited", 0.0), 300);
  const std::vector<PlantSample> off = TrueSamples(WithError("soft_actuator_excited", 0.03), 300);
  EXPECT_NE(off.back().inputs[3], exact.back().inputs[3]);
  EXPECT_NEAR(off[1].inputs[3] / exact[1].inputs[3], 1.0, 0.03 * std::sqrt(12.0));
}

TEST(LawError, DoesNotCountAsTheGapOfAnEffect) {
  EffectRequest request;
  request.name = "force_bias";
  request.gap_ratio = 3.0;
  const auto bias = [&](double share) { return DecideEffects(WithError("contact_rich", share), {request}, 1)[0]; };
  EXPECT_EQ(bias(0.1).values, bias(0.0).values);
}

}  // namespace
}  // namespace armcmc::plant_sim::law_error_test
