// The simulated plant and the estimator read the same plant files, each by itself: they have to agree.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "armcmc/plant_sim/described_simulation.hpp"
#include "armcmc/support/plant_file.hpp"
#include "described_files.hpp"
#include "support/paths.hpp"
#include "support/plant_run.hpp"

namespace armcmc::plant_sim::described_oracle_test {
namespace {

std::vector<std::filesystem::path> PlantFiles() {
  std::vector<std::filesystem::path> files;
  for (const auto& folder : std::filesystem::directory_iterator(test::SourceDir() / "core/plants"))
    if (std::filesystem::exists(folder.path() / "plant.toml")) files.push_back(folder.path() / "plant.toml");
  std::sort(files.begin(), files.end());
  return files;
}

/// Simulates without noise and lets core predict the output from the same signals.
void ExpectTheSame(const DescribedPlant& mine, const armcmc::Plant& theirs, DescribedScenario scenario) {
  scenario.noise = NoiseLaw{};
  DescribedSimulation simulation(mine, scenario);
  std::vector<std::vector<double>> columns(mine.signals.size());
  constexpr int kSamples = 1500;
  for (int n = 0; n < kSamples; ++n) {
    simulation.Next();
    for (std::size_t s = 0; s < columns.size(); ++s) columns[s].push_back(simulation.measured()[s]);
  }
  std::map<std::string, double> values;
  for (const DescribedPlant::Parameter& parameter : mine.parameters) {
    const auto given = scenario.truth.find(parameter.name);
    values[parameter.name] = given == scenario.truth.end() ? parameter.usual : given->second.front();
  }
  const std::vector<double> predicted = test::PlantRun(theirs, values).Output(columns, scenario.dt);
  const std::vector<double>& simulated = columns[static_cast<std::size_t>(mine.SignalAt(mine.output))];
  double size = 0.0;
  for (const double value : simulated) size = std::max(size, std::abs(value));
  EXPECT_GT(size, 0.0) << mine.name;
  // Core's powers are 2^(p log2 x), of a few units in the last place.
  for (std::size_t n = 0; n < simulated.size(); ++n)
    ASSERT_NEAR(simulated[n], predicted[n], 1e-11 * size) << mine.name << " at sample " << n;
}

TEST(DescribedOracle, FingerprintsOfSignalsAreThoseOfTheEstimator) {
  int files = 0;
  for (const std::filesystem::path& path : PlantFiles()) {
    const DescribedPlant mine = ReadDescribedPlant(support::StrictTable::FromFile(path));
    EXPECT_EQ(SignalFingerprint(mine), support::ReadPlant(path).fingerprint()) << path;
    ++files;
  }
  EXPECT_GE(files, 8);
}

TEST(DescribedOracle, EveryPlantThatComesAlongMovesAsTheEstimatorPredicts) {
  for (const std::filesystem::path& path : PlantFiles()) {
    const DescribedPlant mine = ReadDescribedPlant(support::StrictTable::FromFile(path));
    DescribedScenario scenario = UsualScenario(mine);
    if (mine.name == "soft_actuator") {  // its prior means, 0, are valves without flow
      scenario.truth = {{"g", {1e-3}}, {"theta2", {1e-9}}};
      scenario.start = {{"ps", 2e5}, {"p", 2e5}};
      scenario.inputs["u_c"].amplitude = 0.05;
      scenario.inputs["u_d"].kind = InputProgram::Kind::kSteps;
    }
    ExpectTheSame(mine, support::ReadPlant(path), scenario);
  }
}

TEST(DescribedOracle, TheWholeLanguageMeansTheSame) {
  const std::string head =
      "schema = 1\nname = \"words\"\noutput = \"y\"\n[signals]\nx = { unit = \"1\" }\nv = { unit = \"1/s\", "
      "derivative_of = \"x\" }\ny = { unit = \"1\" }\n[constants]\nc = 0.7\n[parameters]\na = { unit = \"1\", mean = "
      "1.3, "
      "sd = 0.1 }\n[noise]\nstd = 1.0\n[let]\nl = \"x^2 + 0.5\"\n[[mode]]\nname = \"m\"\nlaw = \"";
  for (const char* law :
       {"a*-x^2 + 2^-x^2", "a*l/(1 + l) - 3*l - -x", "a*abs(x) + sign(x) - sqrt(l) + exp(x)*log(l)",
        "a*log2(l) + log10(l) + sin(x)*cos(x) + tan(x/3)", "a*asin(x/9) + acos(x/9) + atan(x) + tanh(x)",
        "a*min(x, c) + max(x, c) + clamp(x, -c/5, c/5) + step(x)", "a*if(x > 0 and not x > 0.3 or x <= -0.3, l, x)",
        "a*if(x != 0 and x >= c - 0.6 or x < 0 - c, 1, 0) + if(x == x, 1, 2)", "a*lowpass(x, 0.02) + lowpass(l, 0.3)",
        "a*delay(x, 0.0137) + delay(l, 0.05)", "a*v*integral(x*l) + previous(x) - v*elapsed()", "a*(x + v*t)^2 + l^1.5",
        "if(x > 0, a*v*integral(x), a*lowpass(x, 0.1))", "a + 1e-3*x - .5*x + 2.*x"}) {
    const std::string text = head + law + "\"\n";
    const DescribedPlant mine = ReadDescribedPlant(support::StrictTable::FromText(text, law));
    DescribedScenario scenario = UsualScenario(mine);
    scenario.inputs["x"].amplitude = 0.8;
    SCOPED_TRACE(law);
    ExpectTheSame(mine, support::PlantFromText(text, law), scenario);
  }
}

TEST(DescribedOracle, WhatIsHeldBetweenSamplesMeansTheSame) {
  const std::string head = R"(schema = 1
name = "words"
output = "y"
[signals]
x = { unit = "1", between = "held" }
y = { unit = "1" }
[constants]
w = { value = 0.05, unit = "s" }
[parameters]
a = { unit = "1", mean = 1.3, sd = 0.1 }
[noise]
std = 1.0
[let]
l = "x^2 + 0.5"
[states]
T = { unit = "1", start = "0", substeps = 4, rate = "(a*delay(x, 0.0137) - T)/w" }
[[mode]]
name = "m"
law = ")";
  for (const char* law :
       {"a*lowpass(x, 0.02) + lowpass(l, 0.3)", "a*delay(x, 0.0137) + delay(l, 0.05)",
        "integral(a*x*l)/w + integral(x)/w + lowpass(delay(x, 0.0137), 0.02)", "T", "delay(T, 0.05)"}) {
    const std::string text = head + law + "\"\n";
    const DescribedPlant mine = ReadDescribedPlant(support::StrictTable::FromText(text, law));
    DescribedScenario scenario = UsualScenario(mine);
    scenario.inputs["x"].amplitude = 0.8;
    SCOPED_TRACE(law);
    ExpectTheSame(mine, support::PlantFromText(text, law), scenario);
  }
}

}  // namespace
}  // namespace armcmc::plant_sim::described_oracle_test
