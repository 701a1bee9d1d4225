// The model that the gap workflow writes, in the plant.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "armcmc/gap/model_writer.hpp"
#include "armcmc/support/model_file.hpp"
#include "integration/files.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::test::gap_model_test {
namespace {

std::string Scenario() { return (SourceDir() / "plant_sim/scenarios/contact_rich.toml").string(); }

class WrittenModel : public ::testing::TestWithParam<HiddenEffect> {
 protected:
  /// Forces of a plant with the model; the same seed, so that only the model differs.
  std::vector<double> Plant(const EstimatorSettings& settings) {
    std::ofstream(dir_ / "model.toml") << support::ModelFileText(settings);
    const Outcome o =
        RunProgram(Program("armcmc-plant"), {"--scenario", Scenario(), "--model", dir_ / "model.toml", "--seed", "3",
                                             "--duration", "4", "--csv", dir_ / "run.csv"});
    EXPECT_EQ(o.code, 0) << o.err;
    const Table run = ReadTable(dir_ / "run.csv");
    std::vector<double> forces;
    for (const std::string& f : run.at("f")) forces.push_back(std::stod(f));
    return forces;
  }
  ScratchDir dir_;
};

// A term that is written but not heard would pass every test of the file.
TEST_P(WrittenModel, EveryAddedAmplitudeIsActiveInThePlant) {
  const gap::test::Bench bench(gap::test::Measure({GetParam()}, 3000, 0.05, 3).recording);
  const gap::Fitter fitter(*bench.equation, bench.signals, gap::test::White(0.05));
  const gap::Fitted fit = fitter.Add(bench.Base(fitter), {&bench.Form(GetParam().name), {}});
  EstimatorSettings settings = gap::AugmentedSettings("hunt_crossley", fitter, fit, 0.05);
  // The scenario presses less deep than the recording: a limit must lie among its forces.
  if (GetParam().name == "sensor_saturation")
    settings.effects[0].amplitudes[0] = {"limit", PriorKind::kNormal, 0.2, 0.1, 0.0, 10.0};
  const std::vector<double> at = Plant(settings);
  ASSERT_EQ(at.size(), 4001u);
  for (std::size_t a = 0; a < GetParam().amplitude.size(); ++a) {
    EstimatorSettings moved = settings;
    const double step = 0.01 * moved.effects[0].amplitudes[a].mean;
    moved.effects[0].amplitudes[a].mean += step;
    const std::vector<double> other = Plant(moved);
    double largest = 0.0;
    for (std::size_t n = 0; n < at.size(); ++n) largest = std::max(largest, std::abs(other[n] - at[n]));
    EXPECT_GT(largest / std::abs(step), 1e-2) << settings.effects[0].amplitudes[a].name;
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, WrittenModel, ::testing::ValuesIn(armcmc::test::Catalogue()),
                         [](const auto& at) { return at.param.name; });

}  // namespace
}  // namespace armcmc::test::gap_model_test
