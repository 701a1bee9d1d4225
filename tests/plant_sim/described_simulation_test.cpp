// A described plant in motion, against closed forms.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "armcmc/plant_sim/described_simulation.hpp"

namespace armcmc::plant_sim::described_simulation_test {
namespace {

using testing::HasSubstr;

/// f = k x + d v, x an input.
DescribedPlant Spring() {
  DescribedPlant plant;
  plant.name = "spring";
  plant.output = "f";
  plant.signals = {{"x", "m", "position", ""}, {"v", "m/s", "velocity", "x"}, {"f", "N", "force", ""}};
  plant.constants = {{"w", 2.0}};
  plant.parameters = {{"k", 3.0, false}, {"d", 0.5, false}};
  plant.modes = {{"always", "", "k*x + d*v", "", false}};
  plant.one_law = true;
  return plant;
}

/// y = s, s' = u - c s.
DescribedPlant Tank() {
  DescribedPlant plant;
  plant.name = "tank";
  plant.output = "y";
  plant.signals = {{"u", "1", "drive", ""}, {"y", "1", "level", ""}};
  plant.parameters = {{"c", 1.0, false}};
  plant.modes = {{"always", "", "s", "", false}};
  plant.one_law = true;
  plant.states = {{"s", "u - c*s", "y", "", 1}};
  return plant;
}

InputProgram Formula(const std::string& text) {
  InputProgram program;
  program.kind = InputProgram::Kind::kExpression;
  program.text = text;
  return program;
}

DescribedScenario Moving(const std::string& input, const std::string& text) {
  DescribedScenario scenario;
  scenario.inputs[input] = Formula(text);
  scenario.dt = 0.1;
  return scenario;
}

/// [sample][signal]
std::vector<std::vector<double>> Rows(const DescribedPlant& plant, const DescribedScenario& scenario, int samples) {
  DescribedSimulation simulation(plant, scenario);
  std::vector<std::vector<double>> rows;
  for (int n = 0; n < samples; ++n) {
    simulation.Next();
    rows.push_back(simulation.measured());
  }
  return rows;
}

std::string ErrorOf(const DescribedPlant& plant, const DescribedScenario& scenario) {
  try {
    const DescribedSimulation simulation(plant, scenario);
  } catch (const DescribedError& error) {
    return error.key() + " " + error.what();
  }
  return "none";
}

TEST(DescribedSimulation, FollowsTheLawWithExactDerivatives) {
  DescribedScenario scenario = Moving("x", "0.1*sin(w*t)");
  scenario.truth["k"] = {4.0};
  const auto rows = Rows(Spring(), scenario, 20);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const double t = 0.1 * static_cast<double>(n);
    EXPECT_NEAR(rows[n][0], 0.1 * std::sin(2.0 * t), 1e-15);
    EXPECT_NEAR(rows[n][1], 0.2 * std::cos(2.0 * t), 1e-15);
    EXPECT_NEAR(rows[n][2], 4.0 * rows[n][0] + 0.5 * rows[n][1], 1e-15);
  }
}

TEST(DescribedSimulation, IntegratesByRungeKuttaInSubsteps) {
  DescribedPlant plant = Tank();
  DescribedScenario scenario = Moving("u", "0*t");
  scenario.start["y"] = 2.0;  // what `start` reads
  scenario.truth["c"] = {3.0};
  for (const int substeps : {1, 4}) {
    plant.states[0].substeps = substeps;
    const auto rows = Rows(plant, scenario, 5);
    // The factor of one step of the method for s' = -c s.
    const double z = -3.0 * 0.1 / substeps, factor = 1.0 + z + z * z / 2.0 + z * z * z / 6.0 + z * z * z * z / 24.0;
    for (int n = 0; n < 5; ++n)
      EXPECT_NEAR(rows[static_cast<std::size_t>(n)][1], 2.0 * std::pow(factor, n * substeps), 1e-14);
  }
  scenario.start["s"] = 7.0;
  EXPECT_EQ(Rows(plant, scenario, 1)[0][1], 7.0);
}

TEST(DescribedSimulation, InputsAreLinearBetweenSamples) {
  DescribedPlant plant = Tank();
  plant.states[0].rate = "u + 0*c";
  const auto rows = Rows(plant, Moving("u", "t^2"), 4);
  double sum = 0.0;
  for (std::size_t n = 1; n < rows.size(); ++n) {
    sum += 0.1 * (rows[n - 1][0] + rows[n][0]) / 2.0;
    EXPECT_NEAR(rows[n][1], sum, 1e-15);
  }
}

TEST(DescribedSimulation, AnInputMayBeHeldOrSmoothBetweenSamples) {
  DescribedPlant plant = Tank();
  plant.states[0].rate = "u + 0*c";
  plant.signals[0].between = "held";
  auto rows = Rows(plant, Moving("u", "t^2"), 4);
  EXPECT_NEAR(rows[3][1], 0.1 * (0.0 + 0.01 + 0.04), 1e-15);
  plant.signals[0].between = "smooth";
  rows = Rows(plant, Moving("u", "t^2"), 4);
  EXPECT_NEAR(rows[3][1], 0.3 * 0.3 * 0.3 / 3.0, 1e-15) << "as it is at every time";
}

TEST(DescribedSimulation, ARateRemembersSignals) {
  DescribedPlant plant = Tank();
  plant.lets = {{"late", "delay(u, 0.2)"}, {"twice", "2*late"}};
  plant.states[0].rate = "twice + 0*c";
  const auto rows = Rows(plant, Moving("u", "1 + t"), 8);
  // Twice the integral of u 0.2 s ago, which before the first sample is what it was there.
  EXPECT_NEAR(rows[2][1], 2.0 * 0.2, 1e-14);
  EXPECT_NEAR(rows[7][1], 2.0 * (0.2 + 0.5 + 0.5 * 0.5 / 2.0), 1e-14);
  plant.states[0].rate = "lowpass(u, 0.5) - c*s";
  const auto filtered = Rows(plant, Moving("u", "3 + 0*t"), 4);
  EXPECT_NEAR(filtered[3][1], 3.0 * (1.0 - std::exp(-0.3)), 1e-5);
}

TEST(DescribedSimulation, ARateReadsTheTimeOfItsStage) {
  DescribedPlant plant = Tank();
  plant.states[0].rate = "3*t^2 + 0*c";
  const auto rows = Rows(plant, Moving("u", "0*t"), 6);
  EXPECT_NEAR(rows[5][1], 0.125, 1e-15);  // the method is Simpson's rule here: t^3 exactly
}

TEST(DescribedSimulation, AModeHasItsOwnParametersInRatesToo) {
  DescribedPlant plant = Tank();
  plant.one_law = false;
  plant.parameters[0].per_mode = true;
  plant.lets = {{"own", "c*1"}, {"leak", "own + 0"}};
  plant.states[0].rate = "leak";
  plant.modes = {
      {"up", "u > 0", "s + 10*c", "", false}, {"rest", "u == 0", "5", "", true}, {"down", "", "s", "", false}};
  DescribedScenario scenario = Moving("u", "if(t < 0.35, 1, if(t < 0.65, 0, -1))");
  scenario.truth["c"] = {1.0, 99.0, -2.0};
  const auto rows = Rows(plant, scenario, 10);
  EXPECT_NEAR(rows[3][1], 0.3 + 10.0, 1e-14);
  EXPECT_NEAR(rows[5][1], 5.0, 1e-14) << "the law of a passive mode is shown";
  // From 0.3 to 0.4 the input sinks from 1 to 0: the first mode but for the end, where the last parameter holds.
  const double after = 0.3 + 0.1 / 6.0 * (1.0 + 2.0 + 2.0 - 2.0);
  EXPECT_NEAR(rows[9][1], after - 2.0 * 0.5, 1e-14);
}

TEST(DescribedSimulation, ASignalMayBeAState) {
  DescribedPlant plant = Tank();
  plant.signals = {{"u", "1", "drive", ""}, {"h", "1", "level", ""}, {"hdot", "1/s", "", "h"}, {"y", "1", "level", ""}};
  plant.states[0].start = "0";
  DescribedScenario scenario = Moving("u", "1 + 0*t");
  scenario.inputs["h"].kind = InputProgram::Kind::kState;
  scenario.inputs["h"].text = "s";
  scenario.truth["c"] = {2.0};
  for (const std::vector<double>& row : Rows(plant, scenario, 5)) {
    EXPECT_EQ(row[1], row[3]);
    EXPECT_NEAR(row[2], 1.0 - 2.0 * row[1], 1e-15);
  }
  plant.states[0].measured_by = "h";  // says the same
  scenario.inputs.erase("h");
  EXPECT_EQ(Rows(plant, scenario, 5)[4][1], Rows(plant, scenario, 5)[4][3]);
}

TEST(DescribedSimulation, HidesEffectsThatTheFileDoesNotKnow) {
  DescribedScenario scenario = Moving("x", "0.1*t");
  const auto plain = Rows(Spring(), scenario, 3);
  scenario.hidden = {{HiddenTerm::Slot::kOutput, "", "2*sign(v) + integral(x)"}};
  const auto added = Rows(Spring(), scenario, 3);
  EXPECT_NEAR(added[2][2] - plain[2][2], 2.0 + 0.1 * 0.2 * 0.2 / 2.0, 1e-15);
  scenario.hidden = {{HiddenTerm::Slot::kInput, "x", "delay(x, 0.1) + 0.5"}};
  const auto late = Rows(Spring(), scenario, 3);
  EXPECT_EQ(late[2][0], plain[2][0]) << "recorded as it is";
  EXPECT_NEAR(late[2][2], 3.0 * (0.01 + 0.5) + 0.5 * 0.1, 1e-15);
  DescribedScenario tank = Moving("u", "0*t");
  tank.hidden = {{HiddenTerm::Slot::kRate, "s", "3"}};
  tank.truth["c"] = {0.0};
  EXPECT_NEAR(Rows(Tank(), tank, 3)[2][1], 0.6, 1e-15);
}

TEST(DescribedSimulation, AddsTheNoiseOfTheFileToTheOutputAlone) {
  DescribedPlant plant = Spring();
  plant.noise = {NoiseKind::kGaussian, 2.0};
  DescribedScenario scenario = Moving("x", "0*t");
  double squares = 0.0;
  for (const std::vector<double>& row : Rows(plant, scenario, 4000)) {
    EXPECT_EQ(row[0], 0.0);
    squares += row[2] * row[2];
  }
  EXPECT_NEAR(std::sqrt(squares / 4000.0), 2.0, 5.0 * 2.0 / std::sqrt(2.0 * 4000.0));
  scenario.noise = NoiseLaw{};
  EXPECT_EQ(Rows(plant, scenario, 5)[4][2], 0.0);
}

TEST(DescribedSimulation, ProgramsOfInputsKeepWithinTheirNumbers) {
  DescribedScenario scenario;
  scenario.dt = 1e-3;
  const auto moved = [&](InputProgram::Kind kind, int samples) {
    InputProgram& program = scenario.inputs["x"];
    program = {kind, 0.5, 3.0, 2.0, 8.0, ""};
    return Rows(Spring(), scenario, samples);
  };
  const auto sine = moved(InputProgram::Kind::kSine, 200);
  EXPECT_NEAR(sine[125][0], 3.0 + 0.5 * std::sin(2.0 * std::numbers::pi * 2.0 * 0.125), 1e-14);
  for (const auto kind : {InputProgram::Kind::kMultisine, InputProgram::Kind::kChirp, InputProgram::Kind::kSteps}) {
    const auto rows = moved(kind, 5000);
    double mean = 0.0, most = 0.0;
    for (std::size_t n = 1; n + 1 < rows.size(); ++n) {
      mean += rows[n][0] / static_cast<double>(rows.size());
      most = std::max(most, std::abs(rows[n][0] - 3.0));
      // The third derivative is below 0.5 (2 pi 8 Hz)^3 sqrt(6).
      if (kind == InputProgram::Kind::kSteps) continue;
      EXPECT_NEAR(rows[n][1], (rows[n + 1][0] - rows[n - 1][0]) / 2e-3, 1e-6 / 6.0 * 0.5 * 1.3e5 * 2.5);
    }
    EXPECT_NEAR(mean, 3.0, 0.3);
    EXPECT_GT(most, 0.3);
    EXPECT_LT(most, kind == InputProgram::Kind::kMultisine ? 0.5 * std::sqrt(6.0) : 0.5 + 1e-12);
  }
  EXPECT_EQ(moved(InputProgram::Kind::kSteps, 10)[3], moved(InputProgram::Kind::kSteps, 10)[3]) << "seeded";
}

TEST(DescribedSimulation, RefusesWhatItCannotSimulate) {
  const DescribedScenario good = Moving("x", "t");
  EXPECT_EQ(ErrorOf(Spring(), good), "none");
  EXPECT_THAT(ErrorOf(Spring(), {}), HasSubstr("scenario.inputs.x is missing"));
  EXPECT_THAT(ErrorOf(Spring(), Moving("z", "t")), HasSubstr("scenario.inputs.z"));
  EXPECT_THAT(ErrorOf(Spring(), Moving("v", "t")), HasSubstr("follows from x"));
  EXPECT_THAT(ErrorOf(Spring(), Moving("x", "t + q")), HasSubstr("scenario.inputs.x.expression"));
  EXPECT_THAT(ErrorOf(Spring(), Moving("x", "integral(t)")), HasSubstr("memory"));
  DescribedScenario scenario = good;
  scenario.truth["kk"] = {1.0};
  EXPECT_THAT(ErrorOf(Spring(), scenario), HasSubstr("scenario.truth.kk"));
  scenario.truth = {{"k", {1.0, 2.0}}};
  EXPECT_THAT(ErrorOf(Spring(), scenario), HasSubstr("expected one value"));
  scenario = good;
  scenario.hidden = {{HiddenTerm::Slot::kRate, "s", "1"}};
  EXPECT_THAT(ErrorOf(Spring(), scenario), HasSubstr("scenario.hidden[0].slot"));
  scenario.hidden = {{HiddenTerm::Slot::kInput, "x", "x + k"}};
  EXPECT_THAT(ErrorOf(Spring(), scenario), HasSubstr("reads k"));
  DescribedPlant plant = Spring();
  plant.modes[0].law = "k*x + previous(f)";
  EXPECT_THAT(ErrorOf(plant, good), HasSubstr("law reads the output"));
  plant.modes[0].law = "k*y";
  EXPECT_THAT(ErrorOf(plant, good), HasSubstr("law unknown name \"y\""));
  plant = Spring();
  plant.modes[0].target = "f*2";
  EXPECT_THAT(ErrorOf(plant, good), HasSubstr("target"));
  plant = Tank();
  plant.states[0].rate = "lowpass(s, c)";
  EXPECT_THAT(ErrorOf(plant, Moving("u", "t")), HasSubstr("states.s.rate remembers the state s"));
  plant.states[0].rate = "-delay(twice, c)";
  plant.lets = {{"twice", "2*s"}};
  EXPECT_THAT(ErrorOf(plant, Moving("u", "t")), HasSubstr("states.s.rate remembers the state s"));
  plant = Tank();
  plant.one_law = false;
  plant.modes = {{"late", "previous(u) > 0", "s", "", false}, {"else", "", "2*s", "", false}};
  EXPECT_EQ(ErrorOf(plant, Moving("u", "t")), "none");
  plant.parameters[0].per_mode = true;
  EXPECT_THAT(ErrorOf(plant, Moving("u", "t")), HasSubstr("mode[0].when has a memory"));
}

}  // namespace
}  // namespace armcmc::plant_sim::described_simulation_test
