// Agreement with the stored traces of the paper's two experiments. They are printed with 10 and 12 significant
// digits, so that a perfect re-creation differs by half a unit of the last digit.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "armcmc/plant_sim/simulation.hpp"
#include "builtin_scenario.hpp"
#include "files.hpp"
#include "support/paths.hpp"

namespace armcmc::plant_sim::paper_traces_test {
namespace {

using Columns = std::map<std::string, std::vector<double>>;

Columns ReadColumns(const std::string& relative) {
  const CsvTable table = ReadTable(*test::FindData(relative));
  Columns columns;
  for (const std::vector<double>& row : table.rows)
    for (std::size_t i = 0; i < table.names.size(); ++i) columns[table.names[i]].push_back(row.at(i));
  return columns;
}

/// Half a unit of the last of `digits` significant digits.
double PrintPrecision(double value, int digits) {
  return value == 0.0 ? 0.0 : 0.5 * std::pow(10.0, std::floor(std::log10(std::abs(value))) + 1 - digits);
}

TEST(HuntCrossleyPaper, AgreesWithTheStoredTraceToPrintPrecision) {
  ARMCMC_REQUIRE_DATA("paper/hunt_crossley.csv");
  const Columns stored = ReadColumns("paper/hunt_crossley.csv");
  Simulation simulation(BuiltinScenario("hunt_crossley_paper"), 1);
  ASSERT_EQ(stored.at("t").size(), 20'001u);
  for (std::size_t i = 0; i < stored.at("t").size(); ++i) {
    ASSERT_TRUE(simulation.Next());
    const PlantSample& truth = simulation.truth();
    const auto compare = [&](const char* name, double value, double floor) {
      const double expected = stored.at(name)[i];
      ASSERT_NEAR(value, expected, 1.01 * PrintPrecision(expected, 10) + floor) << name << " at sample " << i;
    };
    // The floor is one rounding of the stored start_force, carried through the motion.
    compare("x", truth.inputs[0], 1e-12);
    compare("v", truth.inputs[1], 1e-12);
    compare("f_true", truth.output, 1e-11);
  }
}

TEST(HuntCrossleyPaper, ExactTrackingDiffersOnlyByTheSampledLoop) {
  Scenario scenario = BuiltinScenario("hunt_crossley_paper");
  Simulation paper(scenario, 1);
  scenario.options.Set("tracking", std::string("exact"));
  Simulation exact(scenario, 1);
  double worst_start = 0.0, worst_later = 0.0;
  for (int i = 0; i <= 20'000; ++i) {
    ASSERT_TRUE(paper.Next() && exact.Next());
    const double difference = std::abs(paper.truth().inputs[0] - exact.truth().inputs[0]);
    (i < 8'000 ? worst_start : worst_later) = std::max(i < 8'000 ? worst_start : worst_later, difference);
  }
  EXPECT_LT(worst_start, 1e-3);              // the two lost commands at the start: 1.6 mm/s, and then exp(-t)
  EXPECT_NEAR(worst_later, 3.426e-4, 2e-6);  // a master velocity 0.361 ms old: 3 x 0.361e-3 / sqrt(10)
}

TEST(HuntCrossley, ExactTrackingSolvesTheEquationOfMotion) {
  // x'' + 3 x' + 2 x = 3 cos t + 1.2 + 2 sin t has, from rest at 0, the solution
  // x = 0.6 + (11 sin t - 3 cos t) / 10 + a exp(-t) + b exp(-2t), with a = -1.7 and b = 1.4.
  Scenario scenario = BuiltinScenario("hunt_crossley_step");
  Simulation simulation(scenario, 1);
  for (int i = 0; i <= 20'000; ++i) {
    ASSERT_TRUE(simulation.Next());
    const double t = simulation.truth().t_s;
    const double x =
        0.6 + (11.0 * std::sin(t) - 3.0 * std::cos(t)) / 10.0 - 1.7 * std::exp(-t) + 1.4 * std::exp(-2.0 * t);
    ASSERT_NEAR(simulation.truth().inputs[0], x, 1e-11) << "t = " << t;
  }
}

TEST(SoftActuatorPaper, AgreesWithTheStoredTraceToPrintPrecision) {
  ARMCMC_REQUIRE_DATA("paper/soft_actuator.csv");
  const Columns stored = ReadColumns("paper/soft_actuator.csv");
  Simulation simulation(BuiltinScenario("soft_actuator_paper"), 1);
  ASSERT_EQ(stored.at("t").size(), 20'001u);
  for (std::size_t i = 0; i < stored.at("t").size(); ++i) {
    ASSERT_TRUE(simulation.Next());
    const PlantSample& truth = simulation.truth();
    const auto compare = [&](const char* name, double value, double relative) {
      const double expected = stored.at(name)[i];
      ASSERT_NEAR(value, expected, PrintPrecision(expected, 12) + relative * std::abs(expected)) << name << " at " << i;
    };
    // The stored run carried the absolute pressure: 1e-11 Pa of rounding in a gauge pressure of 1 Pa.
    compare("u_c", truth.inputs[0], 1e-9);
    compare("u_d", truth.inputs[1], 1e-9);
    compare("p", truth.inputs[2], 1e-14);
    compare("pdot", truth.inputs[3], 1e-9);
    compare("alpha", truth.output, 2e-8);
    compare("flow", simulation.plant().Target(truth), 1e-9);
    const Theta theta = simulation.plant().Truth(truth.mode, truth.t_s);
    ASSERT_NEAR(theta[0], stored.at("theta1_true")[i] + stored.at("theta2_true")[i] * 101'325.0, 1e-15);
    ASSERT_EQ(theta[1], stored.at("theta2_true")[i]);
  }
}

}  // namespace
}  // namespace armcmc::plant_sim::paper_traces_test
