// The model that armcmc-gap writes, in the running estimator.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "armcmc/estimate_t.hpp"
#include "integration/live_pair.hpp"

namespace armcmc::test::gap_live_test {
namespace {

class LiveModel : public LivePair {};

TEST_F(LiveModel, TheEstimatorRunsItAndFindsTheHiddenEffect) {
  scenario_ = SourceDir() / "plant_sim/scenarios/contact_rich.toml";
  seed_ = "5";
  const std::vector<std::string> hide = {"--hide-effect", "force_bias",       "--effect-strength", "5",
                                         "--sealed",      dir_ / "truth.json"};
  std::vector<std::string> offline = {"--scenario", scenario_.string(), "--seed", seed_, "--csv", dir_ / "run.csv"};
  offline.insert(offline.end(), hide.begin(), hide.end());
  ASSERT_EQ(RunProgram(Program("armcmc-plant"), offline).code, 0);
  const Outcome gap = RunProgram(Program("armcmc-gap"), {"--data", dir_ / "run.csv", "--out", dir_ / "gap"});
  ASSERT_EQ(gap.code, 0) << gap.err;
  ASSERT_THAT(gap.out, ::testing::HasSubstr("Missing: force_bias"));
  auto estimator = StartEstimator({"--model", dir_ / "gap/model.toml"});
  ASSERT_EQ(Play("4", hide), 40u) << estimator->err();
  Finish(estimator.get());
  // A shorter run has a stronger effect for the same gap: the one that was played last.
  const double truth = ReadJson(dir_ / "truth.json")["effects"][0]["parameters"]["force"]["value"];
  const std::vector<estimate_t> estimates = recorder_->estimates();
  const estimate_t& last = estimates.back();
  ASSERT_EQ(last.n_params, 4);
  EXPECT_THAT(reinterpret_cast<const char*>(last.param_name[3]), ::testing::StartsWith("force_bias"));
  // The median of half a second: the sensors are noisy, too, and a single pack may look like a change.
  std::vector<double> force;
  for (std::size_t k = estimates.size() - 5; k < estimates.size(); ++k) force.push_back(estimates[k].ar_map[3]);
  std::sort(force.begin(), force.end());
  EXPECT_NEAR(force[2], truth, 0.05 * std::abs(truth));

  // The same model on the recorded run, by the replay: the same numbers to the bit.
  const Outcome replay = RunProgram(
      Program("armcmc-replay"), {"--config", (SourceDir() / "rt/config/hunt_crossley.toml").string(), "--data", Log(),
                                 "--model", dir_ / "gap/model.toml", "--out", dir_ / "replay.csv"});
  ASSERT_EQ(replay.code, 0) << replay.err;
  const Table replayed = ReadTable(dir_ / "replay.csv");
  EXPECT_EQ(replayed.at("pack").back(), std::to_string(last.seq));
  EXPECT_EQ(std::stod(replayed.at("K").back()), last.ar_map[0]);
  EXPECT_EQ(std::stod(replayed.at("force_bias_force").back()), last.ar_map[3]);
}

/// A model file of three additive effects. `amplitudes`: mean and standard deviation of each.
std::string ThreeEffects(const std::array<std::array<double, 2>, 3>& amplitudes) {
  std::ostringstream text;
  text << "schema = 1\nbase = \"hunt_crossley\"\n";
  const char* const names[] = {"force_bias", "coulomb_friction", "viscous_friction"};
  const char* const keys[] = {"force", "force", "coefficient"};
  for (std::size_t i = 0; i < 3; ++i) {
    text << "[[effect]]\nname = \"" << names[i] << "\"\nwhen = \"always\"\n";
    if (i == 1) text << "speed = 0.02\n";
    text << keys[i] << " = { prior = \"normal\", mean = " << amplitudes[i][0] << ", sd = " << amplitudes[i][1]
         << ", lower = " << (i == 0 ? "-3.0" : "0.0") << ", upper = 3.0 }\n";
  }
  return text.str();
}

// The same for the actuator, whose effects enter the flow law of both valves.
TEST_F(LiveModel, TheActuatorsEstimatorFindsItsLeak) {
  config_ = SourceDir() / "rt/config/soft_actuator_excited.toml";
  scenario_ = SourceDir() / "plant_sim/scenarios/soft_actuator_excited.toml";
  const std::vector<std::string> hide = {"--hide-effect", "leak", "--effect-strength", "2"};
  std::vector<std::string> offline = {"--scenario", scenario_.string(),  "--seed",     "3", "--csv", dir_ / "run.csv",
                                      "--sealed",   dir_ / "truth.json", "--duration", "20"};
  offline.insert(offline.end(), hide.begin(), hide.end());
  ASSERT_EQ(RunProgram(Program("armcmc-plant"), offline).code, 0);
  const Outcome gap = RunProgram(
      Program("armcmc-gap"), {"--model", "soft_actuator_excited", "--data", dir_ / "run.csv", "--out", dir_ / "gap"});
  ASSERT_EQ(gap.code, 0) << gap.err;
  ASSERT_THAT(gap.out, ::testing::HasSubstr("Missing in the flow law: leak"));

  auto estimator = StartEstimator({"--model", dir_ / "gap/model.toml"});
  std::vector<std::string> again = hide;  // another leak than the recorded one, of the same law
  again.insert(again.end(), {"--sealed", dir_ / "live_truth.json"});
  ASSERT_EQ(Play("15", again), 150u) << estimator->err();
  const Json report = Finish(estimator.get());
  const double truth = ReadJson(dir_ / "live_truth.json")["effects"][0]["parameters"]["rate"]["value"];

  for (const char* stage : {"collect", "adjust", "execute"}) EXPECT_EQ(report["allocations"][stage], 0) << stage;
  if (report["rt"]["policy"] == "SCHED_FIFO") {
    EXPECT_EQ(report["misses"]["own"], 0);
  }
  const estimate_t last = recorder_->estimates().back();
  int leak = 0;
  while (leak < last.n_params && std::string(reinterpret_cast<const char*>(last.param_name[leak])).find("leak") != 0)
    ++leak;
  ASSERT_LT(leak, last.n_params) << "no parameter of the leak";
  EXPECT_NEAR(last.ar_map_by_mode[0][leak], truth, 5.0 * last.sd_by_mode[0][leak]);
  EXPECT_LT(last.sd_by_mode[0][leak], 0.1 * truth);
  EXPECT_EQ(recorder_->statuses().back().gap_suspected, 0);
}

// The plant has three effects more than the base equations; the estimator knows their form, not their size.
TEST_F(LiveModel, ThreeAddedEffectsAreLearntWithoutAMissOrAnAllocation) {
  constexpr std::array<double, 3> kTruth{0.25, 0.4, 0.3};
  constexpr double kPriorSd = 0.5;
  std::ofstream(dir_ / "plant.toml") << ThreeEffects({{{kTruth[0], 0.1}, {kTruth[1], 0.1}, {kTruth[2], 0.1}}});
  std::ofstream(dir_ / "model.toml") << ThreeEffects({{{-0.5, kPriorSd}, {1.2, kPriorSd}, {1.2, kPriorSd}}});
  auto estimator = StartEstimator({"--model", dir_ / "model.toml"});
  ASSERT_EQ(Play("15", {"--model", dir_ / "plant.toml"}), 150u) << estimator->err();
  const Json report = Finish(estimator.get());
  for (const char* stage : {"collect", "adjust", "execute"}) EXPECT_EQ(report["allocations"][stage], 0) << stage;
  // Without real-time scheduling other programs of the machine may take the processor, which nobody witnesses.
  if (report["rt"]["policy"] == "SCHED_FIFO") {
    EXPECT_EQ(report["misses"]["own"], 0);
  }
  EXPECT_EQ(report["steps"], 150);
  const estimate_t last = recorder_->estimates().back();
  ASSERT_EQ(last.n_params, 6);
  for (int i = 0; i < 3; ++i) {
    const double truth = kTruth[static_cast<std::size_t>(i)];
    // Far from where the prior stood, by the data: narrow, and where the plant is.
    EXPECT_LT(last.sd[3 + i], 0.2 * kPriorSd) << i;
    EXPECT_NEAR(last.ar_map[3 + i], truth, 4.0 * last.sd[3 + i]) << i;
    EXPECT_NEAR(last.ar_map[3 + i], truth, 0.1) << i;
  }
}

}  // namespace
}  // namespace armcmc::test::gap_live_test
