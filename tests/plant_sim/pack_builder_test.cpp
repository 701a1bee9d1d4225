#include "armcmc/plant_sim/pack_builder.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "armcmc/plant_sim/csv_writer.hpp"
#include "builtin_scenario.hpp"
#include "files.hpp"
#include "support/paths.hpp"

namespace armcmc::plant_sim::pack_builder_test {
namespace {

TEST(PackBuilder, PackKHoldsSamplesAfterTheLastPackAndSampleZeroIsInNone) {
  const Scenario scenario = BuiltinScenario("hunt_crossley_paper");
  PackBuilder builder(scenario, 7, 42);
  Simulation simulation(scenario, 7);
  ASSERT_TRUE(simulation.Next());
  for (int k = 1; k <= 3; ++k) {
    ASSERT_TRUE(builder.Next());
    const data_pack_t& pack = builder.pack();
    EXPECT_EQ(pack.seq, k);
    EXPECT_EQ(pack.run_id, 42);
    EXPECT_EQ(pack.n_samples, 100);
    EXPECT_EQ(pack.n_inputs, 2);
    EXPECT_EQ(pack.dt, 1e-3);
    EXPECT_EQ(pack.plant_kind, data_pack_t::PLANT_HUNT_CROSSLEY);
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(simulation.Next());
      EXPECT_EQ(pack.y[i], simulation.measured().output);
      EXPECT_EQ(pack.u[i][0], simulation.measured().inputs[0]);
      EXPECT_EQ(pack.u[i][1], simulation.measured().inputs[1]);
      EXPECT_EQ(builder.truth().y_true[i], simulation.truth().output);
    }
    EXPECT_EQ(simulation.index(), 100 * k);
    EXPECT_EQ(pack.t_last_s, simulation.truth().t_s);
    for (int i = 100; i < data_pack_t::MAX_SAMPLES; ++i) EXPECT_EQ(pack.y[i], 0.0);
  }
}

TEST(PackBuilder, PacksOverlapByAllSamplesButTheNewest) {
  Scenario scenario = BuiltinScenario("hunt_crossley_paper");
  scenario.pack_stride = 10;
  PackBuilder builder(scenario, 7, 42);
  Simulation simulation(scenario, 7);
  std::vector<PlantSample> measured, truth;
  for (int n = 0; n <= 300; ++n) {
    ASSERT_TRUE(simulation.Next());
    measured.push_back(simulation.measured());
    truth.push_back(simulation.truth());
  }
  for (int k = 1; k <= 21; ++k) {
    ASSERT_TRUE(builder.Next());
    const data_pack_t& pack = builder.pack();
    EXPECT_EQ(pack.seq, k);
    EXPECT_EQ(builder.truth().seq, k);
    EXPECT_EQ(pack.n_samples, 100);
    const auto first = static_cast<std::size_t>(10 * (k - 1) + 1);
    for (std::size_t i = 0; i < 100; ++i) {
      ASSERT_EQ(pack.y[i], measured[first + i].output) << "pack " << k << ", sample " << i;
      ASSERT_EQ(pack.u[i][0], measured[first + i].inputs[0]);
      ASSERT_EQ(pack.u[i][1], measured[first + i].inputs[1]);
      ASSERT_EQ(builder.truth().y_true[i], truth[first + i].output);
    }
    EXPECT_EQ(pack.t_last_s, truth[first + 99].t_s) << "advances by 10 samples";
  }
}

TEST(PackBuilder, TruthFollowsAStepOfTheParameters) {
  PackBuilder builder(BuiltinScenario("hunt_crossley_step"), 1, 1);
  for (int k = 1; k <= 80; ++k) ASSERT_TRUE(builder.Next());
  EXPECT_EQ(builder.truth().theta_true[0], 2.0);  // pack 80 ends at 8.0 s, where K has just halved
  EXPECT_EQ(builder.truth().n_params, 3);
  EXPECT_EQ(builder.truth().seq, 80);
}

TEST(PackBuilder, ActuatorPackHasItsFourInputsAndTheParametersOfItsValve) {
  PackBuilder builder(BuiltinScenario("soft_actuator_paper"), 1, 1);
  for (int k = 1; k <= 60; ++k) ASSERT_TRUE(builder.Next());
  EXPECT_EQ(builder.pack().n_inputs, 4);
  EXPECT_EQ(builder.truth().true_mode, 1);
  EXPECT_NEAR(builder.truth().theta_true[0], -2.901175e-4, 1e-12);
  EXPECT_EQ(builder.truth().theta_true[1], -1.9e-9);
}

TEST(PackBuilder, ReportsAPlantThatLeavesTheFiniteRange) {
  Scenario scenario = BuiltinScenario("soft_actuator_excited");
  scenario.options.Set("q3", -1e6);  // a stiffness that pushes away: exp(1000 t)
  PackBuilder builder(scenario, 1, 1);
  bool finite = true;
  for (int k = 0; k < 200 && finite; ++k) finite = builder.Next();
  EXPECT_FALSE(finite);
}

class CsvAgainstPacks : public testing::TestWithParam<const char*> {};

TEST_P(CsvAgainstPacks, AreIdenticalToTheBit) {
  const Scenario scenario = BuiltinScenario(GetParam());
  const test::ScratchDir folder;
  const std::string path = (folder / "data.csv").string();
  CsvWriter csv(scenario, 5, path);
  csv.WriteThrough(500);
  csv.Close();
  const std::vector<std::vector<double>> rows = ReadTable(path).rows;
  ASSERT_EQ(rows.size(), 501u);
  PackBuilder builder(scenario, 5, 1);
  for (std::size_t k = 0; k < 5; ++k) {
    ASSERT_TRUE(builder.Next());
    const data_pack_t& pack = builder.pack();
    for (std::size_t i = 0; i < 100; ++i) {
      const std::vector<double>& row = rows[100 * k + i + 1];
      const auto inputs = static_cast<std::size_t>(pack.n_inputs);
      for (std::size_t j = 0; j < inputs; ++j) EXPECT_EQ(std::memcmp(&row[1 + j], &pack.u[i][j], sizeof(double)), 0);
      EXPECT_EQ(std::memcmp(&row[1 + inputs], &pack.y[i], sizeof(double)), 0);
    }
    EXPECT_EQ(rows[100 * (k + 1)][0], pack.t_last_s);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenarios, CsvAgainstPacks,
                         testing::Values("hunt_crossley_impulsive", "soft_actuator_excited"),
                         [](const auto& at) { return std::string(at.param); });

}  // namespace
}  // namespace armcmc::plant_sim::pack_builder_test
