// The experiments of the actuator: what the valves do and what the pressure shows.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "armcmc/plant_sim/simulation.hpp"
#include "armcmc/plant_sim/soft_actuator_plant.hpp"
#include "builtin_scenario.hpp"

namespace armcmc::plant_sim {
namespace {

using Actuator = SoftActuatorPlant;

std::vector<PlantSample> Follow(const std::string& name) {
  Simulation simulation(BuiltinScenario(name), 1);
  std::vector<PlantSample> samples;
  for (int i = 0; i <= 10'000; ++i) {
    EXPECT_TRUE(simulation.Next());
    samples.push_back(simulation.truth());
  }
  return samples;
}

TEST(ValveProgram, HoldsClosedValvesAfterEveryStep) {
  const std::vector<PlantSample> samples = Follow("experiment_closed_valve_hold");
  const double cycle = 1.6, dwell = 0.4;
  int closed = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double in_cycle = std::fmod(samples[i].t_s + 1e-7, cycle);
    const bool shut = samples[i].inputs[Actuator::kUc] == 0.0 && samples[i].inputs[Actuator::kUd] == 0.0;
    ASSERT_EQ(shut, in_cycle >= dwell) << samples[i].t_s;
    if (!shut) continue;
    ++closed;
    ASSERT_EQ(samples[i].inputs[Actuator::kPressureRate], 0.0);
  }
  EXPECT_GT(closed, 7000);
  // Each step comes to another level.
  EXPECT_GT(std::abs(samples[1000].inputs[Actuator::kPressure] - samples[2600].inputs[Actuator::kPressure]), 1e4);
}

TEST(ValveProgram, FollowsTrianglesOfTwoHeightsAroundZero) {
  const std::vector<PlantSample> samples = Follow("experiment_u_triangle");
  for (const PlantSample& sample : samples) {
    const double t = sample.t_s, share = t - std::floor(t), height = std::fmod(std::floor(t), 2.0) == 0.0 ? 0.1 : 0.04;
    const double opening = height * (1.0 - std::abs(4.0 * std::fmod(share, 0.5) - 1.0));
    ASSERT_NEAR(sample.inputs[Actuator::kUc], share < 0.5 ? 0.3 * opening : 0.0, 1e-12) << t;
    ASSERT_NEAR(sample.inputs[Actuator::kUd], share < 0.5 ? 0.0 : opening, 1e-12) << t;
  }
  // It stays in a range in which the angle means something.
  const auto [least, most] = std::minmax_element(samples.begin() + 2000, samples.end(),
                                                 [](const auto& a, const auto& b) { return a.output < b.output; });
  EXPECT_GT(most->output - least->output, 0.1);
  EXPECT_LT(most->output, 1.5);
}

TEST(ValveProgram, FillsFastAndSlowlyByTurns) {
  const std::vector<PlantSample> samples = Follow("experiment_fast_and_slow_fills");
  const auto rate = [&samples](double from) {
    double fastest = 0.0;
    for (const PlantSample& sample : samples)
      if (sample.t_s >= from && sample.t_s < from + 0.6)
        fastest = std::max(fastest, sample.inputs[Actuator::kPressureRate]);
    return fastest;
  };
  EXPECT_GT(rate(0.0), 7.0 * rate(1.2));
  EXPECT_GT(rate(1.2), 1e3);
  EXPECT_GT(rate(2.4), 4.0 * rate(1.2));
}

}  // namespace
}  // namespace armcmc::plant_sim
