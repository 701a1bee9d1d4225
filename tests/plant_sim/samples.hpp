#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "armcmc/plant_sim/simulation.hpp"

namespace armcmc::plant_sim {

/// What is true in the first samples of a scenario.
[[nodiscard]] inline std::vector<PlantSample> TrueSamples(const Scenario& scenario, int count) {
  Simulation simulation(scenario, 1);
  std::vector<PlantSample> samples;
  for (int i = 0; i < count; ++i) {
    EXPECT_TRUE(simulation.Next()) << scenario.name << ", sample " << i;
    samples.push_back(simulation.truth());
  }
  return samples;
}

/// What the sensors say in the first samples of a scenario.
[[nodiscard]] inline std::vector<PlantSample> MeasuredSamples(const Scenario& scenario, int count) {
  Simulation simulation(scenario, 1);
  std::vector<PlantSample> samples;
  for (int i = 0; i < count; ++i) {
    EXPECT_TRUE(simulation.Next()) << scenario.name << ", sample " << i;
    samples.push_back(simulation.measured());
  }
  return samples;
}

}  // namespace armcmc::plant_sim
