// The experiments of the actuator: what the valves do and what the pressure shows.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "builtin_scenario.hpp"
#include "samples.hpp"
#include "soft_actuator/plant.hpp"

namespace armcmc::plant_sim::valve_program_test {
namespace {

using Actuator = SoftActuatorPlant;

std::vector<PlantSample> Follow(const std::string& name) { return TrueSamples(BuiltinScenario(name), 10'001); }

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
  struct Point {
    std::size_t sample;
    double fill, vent;
  };
  // Half a second of the fill valve, up to 0.3 of the height, and half a second of the vent valve, up to the height.
  for (const Point& at :
       {Point{0, 0.0, 0.0}, Point{125, 0.015, 0.0}, Point{250, 0.03, 0.0}, Point{375, 0.015, 0.0}, Point{500, 0.0, 0.0},
        Point{625, 0.0, 0.05}, Point{750, 0.0, 0.1}, Point{1000, 0.0, 0.0}, Point{1250, 0.012, 0.0},
        Point{1750, 0.0, 0.04}, Point{2250, 0.03, 0.0}, Point{9625, 0.0, 0.02}, Point{9750, 0.0, 0.04}}) {
    EXPECT_NEAR(samples[at.sample].inputs[Actuator::kUc], at.fill, 1e-12) << at.sample;
    EXPECT_NEAR(samples[at.sample].inputs[Actuator::kUd], at.vent, 1e-12) << at.sample;
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
}  // namespace armcmc::plant_sim::valve_program_test
