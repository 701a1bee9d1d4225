// What 20 s of data can say about the actuator's parameters: least squares of flow = p' (g + theta2 (p - p_atm)) per
// valve on what the sensors show, with its Cramer-Rao standard deviation.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <string>

#include "armcmc/plant_sim/simulation.hpp"
#include "builtin_scenario.hpp"
#include "soft_actuator/plant.hpp"

namespace armcmc::plant_sim::identifiability_test {
namespace {

struct Fit {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();

  [[nodiscard]] Eigen::Vector2d Estimate() const { return information.ldlt().solve(gradient); }
  [[nodiscard]] Eigen::Vector2d Sd() const { return information.inverse().diagonal().cwiseSqrt(); }
};

/// Weighted by the noise that the p' sensor puts into the flow, which is nearly all of it.
std::array<Fit, 2> FitValves(const Scenario& scenario, double pdot_std) {
  Simulation simulation(scenario, 11);
  std::array<Fit, 2> fits;
  for (long long i = 0; i <= scenario.num_packs() * scenario.pack_samples; ++i) {
    EXPECT_TRUE(simulation.Next());
    const PlantSample& truth = simulation.truth();
    const PlantSample& measured = simulation.measured();
    const Theta theta = simulation.plant().Truth(truth.mode, truth.t_s);
    const double gauge = truth.inputs[SoftActuatorPlant::kPressure] - 101'325.0;
    const double sd = pdot_std * std::abs(theta[0] + theta[1] * gauge);
    // Regressors from the true states: the bound of a fit without errors in the variables.
    const Eigen::Vector2d row = truth.inputs[SoftActuatorPlant::kPressureRate] * Eigen::Vector2d(1.0, gauge) / sd;
    Fit& fit = fits[static_cast<std::size_t>(truth.mode)];
    fit.information += row * row.transpose();
    const double noise =
        (measured.inputs[SoftActuatorPlant::kPressureRate] - truth.inputs[SoftActuatorPlant::kPressureRate]) *
        (theta[0] + theta[1] * gauge);
    fit.gradient += row * (simulation.plant().Target(truth) + noise) / sd;
  }
  return fits;
}

TEST(SoftActuatorExcited, AllFourParametersCanBeIdentified) {
  const Scenario scenario = BuiltinScenario("soft_actuator_excited");
  const std::array<Fit, 2> fits = FitValves(scenario, 500.0);
  Simulation simulation(scenario, 11);
  for (int mode = 0; mode < 2; ++mode) {
    const Theta truth = simulation.plant().Truth(mode, 0.0);
    const Eigen::Vector2d sd = fits[static_cast<std::size_t>(mode)].Sd();
    const Eigen::Vector2d estimate = fits[static_cast<std::size_t>(mode)].Estimate();
    for (int i = 0; i < 2; ++i) {
      const double relative_sd = sd[i] / std::abs(truth[static_cast<std::size_t>(i)]);
      const std::string name = scenario.family->truth_names[static_cast<std::size_t>(i)] + "_" +
                               scenario.family->modes[static_cast<std::size_t>(mode)];
      RecordProperty("relative_sd_" + name, std::to_string(relative_sd));
      EXPECT_LT(relative_sd, 0.01) << name;
      EXPECT_NEAR(estimate[i], truth[static_cast<std::size_t>(i)], 4.5 * sd[i]) << name;
    }
  }
}

TEST(SoftActuatorExcited, SwingsAsARealActuatorWould) {
  const Scenario scenario = BuiltinScenario("soft_actuator_excited");
  Simulation simulation(scenario, 1);
  std::array<long long, 2> samples{};
  double highest = 0.0, widest_bend = 0.0, largest_opening = 0.0;
  for (long long i = 0; i <= 20'000; ++i) {
    ASSERT_TRUE(simulation.Next());
    const PlantSample& truth = simulation.truth();
    ++samples[static_cast<std::size_t>(truth.mode)];
    highest = std::max(highest, truth.inputs[2] - 101'325.0);
    widest_bend = std::max(widest_bend, truth.output);
    largest_opening = std::max({largest_opening, truth.inputs[0], truth.inputs[1]});
  }
  EXPECT_GT(samples[0], 4'000);
  EXPECT_GT(samples[1], 4'000);
  EXPECT_GT(highest, 60e3);
  EXPECT_GT(widest_bend, 1.0);
  EXPECT_LT(widest_bend, 2.0);
  EXPECT_NEAR(largest_opening, 0.1, 1e-12);
}

}  // namespace
}  // namespace armcmc::plant_sim::identifiability_test
