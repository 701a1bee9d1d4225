// Drift where a pack cannot tell the parameters apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "core/estimator_rig.hpp"
#include "core/plant/described_packs.hpp"
#include "core/plant/plants.hpp"

namespace armcmc::drift_in_weak_directions_test {
namespace {

/// A seal that is pressed on by q; P_0 knows its parameters well.
PlantDescription Seal() {
  PlantDescription plant;
  plant.name = "seal";
  plant.output = "F";
  plant.law = "d*v + Fc*sign(v) + off + A*q";
  plant.signals = {{"v", "m/s", "velocity", ""}, {"q", "1", "", ""}, {"F", "N", "force", ""}};
  plant.parameters = {{"d", "N s/m", "normal", 200.0, 10.0, 0.0, 1e5},
                      {"Fc", "N", "normal", 1.0, 0.1, 0.0, 1e4},
                      {"off", "N", "normal", 0.5, 0.05, -1e3, 1e3},
                      {"A", "N", "normal", 1.3, 0.02, 0.0, 1e3}};
  plant.noise.std = 0.2;
  plant.noise.estimate = true;
  return plant;
}

// In one direction of motion, friction and offset are the same, and the pressure hardly changes: what a pack tells of
// the one is a slope that a drift of another would have, too. Effective parameters that follow such a slope are far
// beyond the bounds, which cut them off, and what is published then is hundreds of standard deviations of P_0 away.
TEST(DriftInWeakDirections, StaysWhereTheDataHaveNoSay) {
  constexpr int kStroke = 8;  // packs in one direction
  constexpr double kFarthest = 15.0;
  const PlantDescription seal = Seal();
  const auto plant = test::Program(seal);
  EstimatorSettings settings = DescribedSettings(plant);
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = 4000;
  test::Rig rig(settings);
  test::GaussianNoise noise(0.2);
  const auto wave = [](double t, double period) { return std::sin(2.0 * std::numbers::pi * t / period); };
  double farthest = 0.0, drifted = 0.0;
  for (std::int64_t seq = 1; seq <= 80; ++seq) {
    const double direction = (seq - 1) / kStroke % 2 == 0 ? 1.0 : -1.0;
    const DataPack pack = test::DescribedPack(
        *plant, seq,
        [&](double t) {
          test::PlantSample s;
          const double friction = 1.0 + 0.6 * wave(t, 37.0) + 0.3 * wave(t, 5.3);
          s.u[0] = direction * (0.01 + 0.002 * wave(t, 1.4));
          s.u[1] = 3.0 + 0.02 * wave(t, 3.1) + 0.3 * wave(t, 200.0);
          s.y = 200.0 * s.u[0] + friction * direction + 0.5 + 1.3 * s.u[1] + noise();
          return s;
        },
        100, 0.01);
    const ModeEstimate& estimate = rig.Step(pack).modes[0];
    drifted = std::max(drifted, estimate.p_drifted);
    for (std::size_t d = 0; d < seal.parameters.size(); ++d) {
      const ParameterDescription& p = seal.parameters[d];
      farthest = std::max(farthest, std::fabs(estimate.marginal[d].ar_ap - p.mean) / p.sd);
    }
  }
  EXPECT_GT(drifted, 0.5);
  ::testing::Test::RecordProperty("farthest", std::to_string(farthest));
  EXPECT_LT(farthest, kFarthest);
}

}  // namespace
}  // namespace armcmc::drift_in_weak_directions_test
