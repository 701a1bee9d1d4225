#include "scenario_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <armcmc/support/strict_toml.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "builtin_scenario.hpp"
#include "files.hpp"
#include "samples.hpp"
#include "support/paths.hpp"

namespace armcmc::plant_sim::scenario_file_test {
namespace {

using support::ConfigError;
using testing::HasSubstr;

/// The paper's scenario with one text replaced.
Scenario LoadChanged(const std::string& from, const std::string& to, const std::string& base = "hunt_crossley_paper") {
  std::string changed = Text(test::SourceDir() / "plant_sim" / "scenarios" / (base + ".toml"));
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
    Simulation simulation(scenario, 1);
    const long long last = scenario.last_sample(scenario.num_packs());
    EXPECT_GE(last, 10'000) << entry.path();
    for (long long i = 0; i <= last; ++i) ASSERT_TRUE(simulation.Next()) << entry.path() << " sample " << i;
    ++count;
  }
  EXPECT_GE(count, 21);
}

TEST(ScenarioFile, ChatterSwitchesModesAgainAndAgain) {
  const std::vector<PlantSample> samples = TrueSamples(BuiltinScenario("hunt_crossley_chatter"), 20'001);
  int switches = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) switches += samples[i].mode != samples[i - 1].mode ? 1 : 0;
  EXPECT_GT(switches, 50);
}

TEST(ScenarioFile, ReadsPacksThatOverlap) {
  const Scenario scenario = LoadChanged("pack_period_s = 0.1", "pack_period_s = 0.1\npack_stride = 10");
  EXPECT_EQ(scenario.pack_samples, 100);
  EXPECT_EQ(scenario.stride(), 10);
  EXPECT_DOUBLE_EQ(scenario.pack_period_s(), 0.01);
  EXPECT_EQ(scenario.num_packs(), 1991) << "the last one ends with the 20 s";
  EXPECT_EQ(scenario.last_sample(1), 100);
  EXPECT_EQ(scenario.last_sample(1991), 20'000);
  EXPECT_EQ(scenario.end_of_pack_ns(1), 100'000'000);
  EXPECT_EQ(scenario.end_of_pack_ns(3), 120'000'000);
  const Scenario plain = BuiltinScenario("hunt_crossley_paper");
  EXPECT_EQ(plain.stride(), 100);
  EXPECT_EQ(plain.num_packs(), 200);
  EXPECT_EQ(plain.last_sample(2), 200);
  EXPECT_EQ(plain.end_of_pack_ns(2), 200'000'000);
}

TEST(ScenarioFile, AStrideThatDoesNotDivideAPackIsAnError) {
  for (const char* stride : {"0", "-1", "101", "30", "1.5"}) {
    const std::string problem =
        Problem("pack_period_s = 0.1", "pack_period_s = 0.1\npack_stride = " + std::string(stride));
    EXPECT_THAT(problem, HasSubstr("changed.toml:7:")) << stride;
    EXPECT_THAT(problem, HasSubstr("pack_stride")) << stride;
  }
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
  EXPECT_THAT(Problem("tracking = \"paper\"", "tracking = \"paper\"\nprogram = \"dance\""), HasSubstr("slow_triangle"));
  EXPECT_THAT(Problem("tracking = \"paper\"", "tracking = \"paper\"\ndepth = 0.0"), HasSubstr("motion.depth"));
  EXPECT_THAT(Problem("controller = \"pressure_steps\"", "controller = \"sleep\"", "soft_actuator_excited"),
              HasSubstr("closed_valve_hold"));
  EXPECT_THAT(Problem("duration_s = 20.0", "duration_s = nan"), HasSubstr("duration_s"));
  EXPECT_THAT(Problem("switch_times_s = [5.0, 14.0]", "switch_times_s = [5.0]", "soft_actuator_paper"),
              HasSubstr("one entry more"));
  EXPECT_THAT(Problem("theta1_c = -2.14e-4", "theta1_c = -9e-3", "soft_actuator_paper"), HasSubstr("must be positive"));
}

TEST(ScenarioFile, ReadsTheColourAndTheLevelOfTheNoise) {
  const NoiseLaw law =
      LoadChanged("std = 0.1", "std_share = 0.02\ncorrelation = 0.9\ngrowth = 0.5", "hunt_crossley_heavy_tailed")
          .noise.back();
  EXPECT_EQ(law.kind, NoiseKind::kStudentT);
  EXPECT_EQ(law.correlation, 0.9);
  EXPECT_EQ(law.growth, 0.5);
  // The rms force in contact of the motion that the paper's scenario shares.
  double sum = 0.0;
  int contact = 0;
  for (const PlantSample& sample : TrueSamples(BuiltinScenario("hunt_crossley_heavy_tailed"), 20'001)) {
    if (sample.mode != 0) continue;
    sum += sample.output * sample.output;
    ++contact;
  }
  EXPECT_NEAR(law.reference, std::sqrt(sum / contact), 1e-12 * law.reference);
  EXPECT_NEAR(law.std, 0.02 * law.reference, 1e-15);
}

TEST(ScenarioFile, RejectsNoiseThatContradictsItself) {
  EXPECT_THAT(Problem("std = 0.1", "std = 0.1\nstd_share = 0.01"), HasSubstr("contradicts std"));
  EXPECT_THAT(Problem("std = 0.1", "std = 0.1\ncorrelation = 1.0"), HasSubstr("0.99"));
  EXPECT_THAT(Problem("std = 0.1", "std = 0.1\ncorrelation = 0.5\ncorrelation_to = 0.4"), HasSubstr("correlation_to"));
  EXPECT_THAT(Problem("std = 0.1", "std = 0.1\ngrowth = -1"), HasSubstr("growth"));
  EXPECT_THAT(Problem("std = 0.003", "std_share = 0.01", "experiment_free_air_chirp"),
              HasSubstr("noise.f.std_share refers to the rms of f"));
}

TEST(ScenarioFile, DrawsParametersFromTheirRanges) {
  const auto load = [](std::uint64_t seed) {
    return LoadScenario(test::SourceDir() / "plant_sim/scenarios/contact_rich_mm.toml", {}, seed).schedule;
  };
  double least_k = 1e9, most_k = 0.0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Schedule drawn = load(seed);
    const double k = drawn.Value(0, 0.0), b = drawn.Value(1, 0.0), p = drawn.Value(2, 0.0);
    ASSERT_TRUE(p >= 1.1 && p <= 1.9);
    ASSERT_TRUE(b >= 2.0 * k && b <= 12.0 * k);
    const double at_one_mm = k * std::pow(1e-3, p);
    ASSERT_TRUE(at_one_mm >= 0.3 * (1 - 1e-12) && at_one_mm <= 3.0 * (1 + 1e-12)) << at_one_mm;
    least_k = std::min(least_k, at_one_mm);
    most_k = std::max(most_k, at_one_mm);
  }
  EXPECT_LT(least_k, 0.33);
  EXPECT_GT(most_k, 2.7);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(load(7).Value(i, 0.0), load(7).Value(i, 0.0));
    EXPECT_NE(load(7).Value(i, 0.0), load(8).Value(i, 0.0));
  }
}

TEST(ScenarioFile, RejectsRangesThatMakeNoSense) {
  const auto problem = [](const std::string& k) { return Problem("K = 4.0", "K = " + k); };
  EXPECT_THAT(problem("{ low = 1.0 }"), HasSubstr("high is missing"));
  EXPECT_THAT(problem("{ low = 2.0, high = 1.0 }"), HasSubstr("parameters.K.high"));
  EXPECT_THAT(problem("{ low = -2.0, high = 1.0 }"), HasSubstr("parameters.K.low"));
  EXPECT_THAT(problem("{ low = 0.0, high = 1.0, law = \"log_uniform\" }"), HasSubstr("must be positive"));
  EXPECT_THAT(problem("{ low = 1.0, high = 2.0, law = \"normal\" }"), HasSubstr("log_uniform"));
  EXPECT_THAT(problem("{ low = 1.0, high = 2.0, step = 0.1 }"), HasSubstr("step"));
  EXPECT_THAT(problem("{ low = 1.0, high = 2.0, times = \"K\" }"), HasSubstr("times"));
  EXPECT_THAT(problem("{ low = 1.0, high = 2.0, times = \"B\", at_depth = 1.0 }"), HasSubstr("contradicts times"));
  EXPECT_THAT(problem("{ low = 1e9, high = 1e9, at_depth = 1e-9 }"), HasSubstr("outside"));
  EXPECT_THAT(problem("\"stiff\""), HasSubstr("number"));
  EXPECT_THAT(Problem("p = 1.7", "p = { low = 1.1, high = 1.9, at_depth = 1.0 }"), HasSubstr("no power of the depth"));
}

TEST(ScenarioFile, RejectsChangesThatContradictEachOther) {
  EXPECT_THAT(Problem("to_value = 2.0", "to_s = 7.0\nto_value = 2.0", "hunt_crossley_step"), HasSubstr("to_s"));
  EXPECT_THAT(Problem("to_value = 2.0", "to_s = 15.0\nto_value = 2.0", "hunt_crossley_step"), HasSubstr("overlap"));
  EXPECT_THAT(Problem("parameter = \"K\"", "parameter = \"k\"", "hunt_crossley_step"), HasSubstr("parameter"));
  EXPECT_THAT(Problem("to_value = 2.0", "", "hunt_crossley_step"), HasSubstr("to_value is missing"));
}

/// The rich contact with a recorded motion and recorded noise, whose files hold these rows.
Scenario LoadRecorded(const std::string& motion_rows, const std::string& noise_rows, const std::string& more = "") {
  const test::ScratchDir folder;
  std::ofstream(folder / "motion.csv") << "t,x\n" << motion_rows;
  std::ofstream(folder / "noise.csv") << "t,e\n" << noise_rows;
  std::ofstream(folder / "scenario.toml")
      << "schema = 1\nplant = \"hunt_crossley\"\nduration_s = 1.0\n[parameters]\nK = 4.0\nB = 1.0\np = 1.5\n"
         "[motion]\ntracking = \"prescribed\"\nprogram = \"recorded\"\nrecording = \"motion.csv\"\n"
         "[noise.f]\nkind = \"recorded\"\nrecording = \"noise.csv\"\nstd = 0.2\n"
      << more;
  return LoadScenario(folder / "scenario.toml");
}

const std::string kRamp = "0.0,0.1\n0.5,0.6\n1.0,1.1\n", kSteps = "0.0,7.0\n0.5,3.0\n1.0,7.0\n1.5,3.0\n";

TEST(ScenarioFile, ReadsRecordedMotionAndNoiseBesideIt) {
  const Scenario scenario = LoadRecorded(kRamp, kSteps);
  EXPECT_EQ(scenario.options.Recorded("recording")->interval_s, 0.5);
  EXPECT_THAT(scenario.options.Recorded("recording")->values, testing::ElementsAre(0.1, 0.6, 1.1));
  // Zero mean and unit variance: the level is that of the scenario.
  EXPECT_THAT(scenario.noise.back().recording->values, testing::ElementsAre(1.0, -1.0, 1.0, -1.0));
  EXPECT_EQ(NoiseSd(scenario.noise.back()), 0.2);
  Simulation simulation(scenario, 1);
  ASSERT_TRUE(simulation.Next());
  EXPECT_NEAR(simulation.truth().inputs[0], 0.1, 0.05);
}

TEST(ScenarioFile, RefusesARecordingThatIsNoneOrNotEven) {
  const auto problem = [](const std::string& motion, const std::string& noise, const std::string& more = "") {
    try {
      static_cast<void>(LoadRecorded(motion, noise, more));
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(problem("0.0,0.1\n0.5,0.6\n1.5,1.1\n", kSteps), HasSubstr("not even"));
  EXPECT_THAT(problem("0.0,0.1\n", kSteps), HasSubstr("fewer than two"));
  EXPECT_THAT(problem("0.0,hello\n0.5,0.6\n", kSteps), HasSubstr("motion.csv:2"));
  EXPECT_THAT(problem(kRamp, "0.0,2.0\n0.5,2.0\n"), HasSubstr("no noise"));
  EXPECT_THAT(problem(kRamp, kSteps, "correlation = 0.5\n"), HasSubstr("has its own correlation"));
  EXPECT_THAT(problem(kRamp, kSteps, "correlation_to = 0.5\n"), HasSubstr("has its own correlation"));
}

}  // namespace
}  // namespace armcmc::plant_sim::scenario_file_test
