// The model that armcmc-gap writes, in the running estimator.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "armcmc/estimate_t.hpp"
#include "integration/live_pair.hpp"

namespace armcmc::test {
namespace {

class LiveModel : public LivePair {};

TEST_F(LiveModel, TheEstimatorRunsItAndFindsTheHiddenEffect) {
  const std::string scenario = (SourceDir() / "plant_sim/scenarios/contact_rich.toml").string();
  const std::vector<std::string> hide = {"--hide-effect", "force_bias",       "--effect-strength", "5",
                                         "--sealed",      dir_ / "truth.json"};
  std::vector<std::string> offline = {"--scenario", scenario, "--seed", "5", "--csv", dir_ / "run.csv"};
  offline.insert(offline.end(), hide.begin(), hide.end());
  ASSERT_EQ(RunProgram(Program("armcmc-plant"), offline).code, 0);
  const Outcome gap = RunProgram(Program("armcmc-gap"), {"--data", dir_ / "run.csv", "--out", dir_ / "gap"});
  ASSERT_EQ(gap.code, 0) << gap.err;
  ASSERT_THAT(gap.out, ::testing::HasSubstr("Missing: force_bias"));
  std::ifstream sealed(dir_ / "truth.json");
  const double truth = nlohmann::json::parse(sealed)["effects"][0]["parameters"]["force"]["value"];

  auto estimator = StartEstimator({"--model", dir_ / "gap/model.toml"});
  std::vector<std::string> live = {"--scenario", scenario, "--seed", "5", "--duration", "4", "--lcm-url", bus_->url()};
  live.insert(live.end(), hide.begin(), hide.end());
  Process plant(Program("armcmc-plant"), live);
  ASSERT_EQ(plant.Wait(std::chrono::seconds(30)).code, 0) << plant.err();
  Finish(estimator.get());
  ASSERT_GT(recorder_->estimates().size(), 20u);
  const estimate_t last = recorder_->estimates().back();
  ASSERT_EQ(last.n_params, 4);
  EXPECT_THAT(reinterpret_cast<const char*>(last.param_name[3]), ::testing::StartsWith("force_bias"));
  EXPECT_NEAR(last.ar_map[3], truth, 0.2 * std::abs(truth));

  // The same model on the recorded run, by the replay: the same numbers to the bit.
  const Outcome replay = RunProgram(
      Program("armcmc-replay"), {"--config", (SourceDir() / "rt/config/hunt_crossley.toml").string(), "--data", Log(),
                                 "--model", dir_ / "gap/model.toml", "--out", dir_ / "replay.csv"});
  ASSERT_EQ(replay.code, 0) << replay.err;
  std::ifstream csv(dir_ / "replay.csv");
  std::string line, final_line;
  std::getline(csv, line);
  const auto column = [](const std::string& text, const std::string& wanted, const std::string& header) {
    std::istringstream names(header), cells(text);
    for (std::string name, cell; std::getline(names, name, ',') && std::getline(cells, cell, ',');)
      if (name == wanted) return cell;
    return std::string("no column ") + wanted;
  };
  const std::string header = line;
  while (std::getline(csv, line)) final_line = line;
  EXPECT_EQ(column(final_line, "pack", header), std::to_string(last.seq));
  EXPECT_EQ(std::strtod(column(final_line, "K", header).c_str(), nullptr), last.ar_map[0]);
  EXPECT_EQ(std::strtod(column(final_line, "force_bias_force", header).c_str(), nullptr), last.ar_map[3]);
}

}  // namespace
}  // namespace armcmc::test
