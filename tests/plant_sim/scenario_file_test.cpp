#include "scenario_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <armcmc/support/strict_toml.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "armcmc/plant_sim/simulation.hpp"
#include "support/paths.hpp"

namespace armcmc::plant_sim {
namespace {

using support::ConfigError;
using testing::HasSubstr;

/// The paper's scenario with one text replaced.
Scenario LoadChanged(const std::string& from, const std::string& to, const std::string& base = "hunt_crossley_paper") {
  std::ifstream file(test::SourceDir() / "plant_sim" / "scenarios" / (base + ".toml"));
  std::stringstream text;
  text << file.rdbuf();
  std::string changed = text.str();
  const std::size_t at = changed.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  changed.replace(at, from.size(), to);
  const test::ScratchDir folder;
  const std::filesystem::path path = folder / "changed.toml";
  std::ofstream(path) << changed;
  return LoadScenario(path);
}

std::string Problem(const std::string& from, const std::string& to, const std::string& base = "hunt_crossley_paper") {
  try {
    static_cast<void>(LoadChanged(from, to, base));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ScenarioFile, EveryScenarioThatComesWithTheProgramRunsToItsEnd) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::SourceDir() / "plant_sim" / "scenarios")) {
    const Scenario scenario = LoadScenario(entry.path());
    EXPECT_EQ(scenario.num_packs(), 200) << entry.path();
    Simulation simulation(scenario, 1);
    for (int i = 0; i <= 20'000; ++i) ASSERT_TRUE(simulation.Next()) << entry.path() << " sample " << i;
    ++count;
  }
  EXPECT_GE(count, 8);
}

TEST(ScenarioFile, ChatterSwitchesModesAgainAndAgain) {
  Simulation simulation(LoadScenario(test::SourceDir() / "plant_sim/scenarios/hunt_crossley_chatter.toml"), 1);
  int switches = 0, last = -1;
  for (int i = 0; i <= 20'000; ++i) {
    ASSERT_TRUE(simulation.Next());
    if (last >= 0 && simulation.truth().mode != last) ++switches;
    last = simulation.truth().mode;
  }
  EXPECT_GT(switches, 50);
}

TEST(ScenarioFile, ReadsPacksDownToOneMillisecond) {
  EXPECT_EQ(LoadChanged("pack_period_s = 0.1", "pack_period_s = 0.001").pack_samples, 1);
  EXPECT_EQ(LoadChanged("sample_interval_s = 0.001", "sample_interval_s = 0.0005").pack_samples, 200);
}

TEST(ScenarioFile, RejectsPacksThatAreNoWholeNumberOfSamplesOrTooLong) {
  EXPECT_THAT(Problem("pack_period_s = 0.1", "pack_period_s = 0.0015"),
              HasSubstr("pack_period_s = 0.0015: must hold a whole"));
  EXPECT_THAT(Problem("pack_period_s = 0.1", "pack_period_s = 0.257"), HasSubstr("1 to 256"));
  EXPECT_THAT(Problem("pack_period_s = 0.1", "pack_period_s = 0.0001"), HasSubstr("pack_period_s"));
}

TEST(ScenarioFile, NamesFileLineAndKeyOfATypo) {
  const std::string problem = Problem("duration_s", "duratoin_s");
  EXPECT_THAT(problem, HasSubstr("changed.toml:4"));
  EXPECT_THAT(problem, HasSubstr("duratoin_s"));
}

TEST(ScenarioFile, RejectsNonsense) {
  EXPECT_THAT(Problem("schema = 1", "schema = 2"), HasSubstr("schema"));
  EXPECT_THAT(Problem("\"hunt_crossley\"", "\"pendulum\""), HasSubstr("soft_actuator"));
  EXPECT_THAT(Problem("K = 4.0", "K = -4.0"), HasSubstr("K"));
  EXPECT_THAT(Problem("p = 1.7", ""), HasSubstr("p is missing"));
  EXPECT_THAT(Problem("K = 4.0", "K = 4.0\nq = 1.0"), HasSubstr("q"));
  EXPECT_THAT(Problem("kind = \"gaussian\"", "kind = \"pink\""), HasSubstr("student_t"));
  EXPECT_THAT(Problem("std = 0.1", "std = -0.1"), HasSubstr("std"));
  EXPECT_THAT(Problem("std = 0.1", "std = 0.1\ndof = 3"), HasSubstr("dof"));
  EXPECT_THAT(Problem("[noise.f]", "[noise.force]"), HasSubstr("force"));
  EXPECT_THAT(Problem("master_omega = [1.0]", "master_omega = [1.0, 2.0]"), HasSubstr("one entry per wave"));
  EXPECT_THAT(Problem("tracking = \"paper\"", "tracking = \"good\""), HasSubstr("exact"));
  EXPECT_THAT(Problem("duration_s = 20.0", "duration_s = nan"), HasSubstr("duration_s"));
  EXPECT_THAT(Problem("switch_times_s = [5.0, 14.0]", "switch_times_s = [5.0]", "soft_actuator_paper"),
              HasSubstr("one entry more"));
  EXPECT_THAT(Problem("theta1_c = -2.14e-4", "theta1_c = -9e-3", "soft_actuator_paper"), HasSubstr("must be positive"));
}

TEST(ScenarioFile, RejectsChangesThatContradictEachOther) {
  EXPECT_THAT(Problem("to_value = 2.0", "to_s = 7.0\nto_value = 2.0", "hunt_crossley_step"), HasSubstr("to_s"));
  EXPECT_THAT(Problem("to_value = 2.0", "to_s = 15.0\nto_value = 2.0", "hunt_crossley_step"), HasSubstr("overlap"));
  EXPECT_THAT(Problem("parameter = \"K\"", "parameter = \"k\"", "hunt_crossley_step"), HasSubstr("parameter"));
  EXPECT_THAT(Problem("to_value = 2.0", "", "hunt_crossley_step"), HasSubstr("to_value is missing"));
}

}  // namespace
}  // namespace armcmc::plant_sim
