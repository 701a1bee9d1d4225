// The model that armcmc-gap writes, in the running estimator.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
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
  const estimate_t& last = recorder_->estimates().back();
  ASSERT_EQ(last.n_params, 4);
  EXPECT_THAT(reinterpret_cast<const char*>(last.param_name[3]), ::testing::StartsWith("force_bias"));
  EXPECT_NEAR(last.ar_map[3], truth, 0.2 * std::abs(truth));
}

}  // namespace
}  // namespace armcmc::test
