#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <sstream>

#include "integration/live_pair.hpp"
#include "integration/spy_screen.hpp"

namespace armcmc::test {
namespace {

std::string Read(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The estimator with everybody looking on: lcm-spy with its three panels, lcm-logger, armcmc-watch.
class WatchedRun : public LivePair, public ::testing::WithParamInterface<int> {
 protected:
  void SetUp() override {
    const std::string missing = SpyScreen::MissingTools();
    if (!missing.empty()) GTEST_SKIP() << missing;
    LivePair::SetUp();
  }

  /// A configuration and a scenario of so many packs a second.
  void WriteFiles(int rate_hz) {
    const std::string period = std::to_string(1000 / rate_hz);
    std::string config = Read(SourceDir() / "rt/config/hunt_crossley.toml");
    config = std::regex_replace(config, std::regex("period_ms = 100"), "period_ms = " + period);
    config = std::regex_replace(config, std::regex("deadline_ms = 100"), "deadline_ms = " + period);
    config = std::regex_replace(config, std::regex("adjust_budget_ms = 80"),
                                "adjust_budget_ms = " + std::to_string(700 / rate_hz));
    config_ = dir_ / "config.toml";
    std::ofstream(config_) << config;
    std::string scenario = Read(SourceDir() / "plant_sim/scenarios/hunt_crossley_paper.toml");
    scenario = std::regex_replace(scenario, std::regex("pack_period_s = 0.1"),
                                  "pack_period_s = " + std::to_string(1.0 / rate_hz));
    scenario_ = dir_ / "scenario.toml";
    std::ofstream(scenario_) << scenario;
  }

  /// Fifteen seconds with plant and estimator. @return the estimator's report.
  nlohmann::json Run(int rate_hz) {
    recorder_ = std::make_unique<BusRecorder>(bus_->url(), Log());
    auto estimator = StartEstimator();
    auto plant = StartPlant("15");
    EXPECT_EQ(plant->Wait(std::chrono::seconds(60)).code, 0) << plant->err();
    EXPECT_TRUE(recorder_->WaitForEstimates(static_cast<std::size_t>(14 * rate_hz))) << estimator->err();
    return Finish(estimator.get());
  }
};

TEST_P(WatchedRun, TheEstimatorMissesNothingOfItsOwn) {
  const int rate_hz = GetParam();
  WriteFiles(rate_hz);
  const SpyScreen screen;
  auto spy = screen.StartSpy({"--lcm-url", bus_->url(), "--panels"});
  ASSERT_TRUE(screen.Window("EST_STATUS - ARMCMC")) << spy->err();
  Process logger("/usr/bin/env", {"lcm-logger", "--lcm-url=" + bus_->url(), dir_ / "logger.lcm"});
  Process watch(Program("armcmc-watch"), {"--lcm-url", bus_->url(), "--json"});
  const nlohmann::json report = Run(rate_hz);

  EXPECT_EQ(report["period_ms"], 1000 / rate_hz);
  EXPECT_GT(report["steps"], 14 * rate_hz);
  EXPECT_EQ(report["packs"]["lost"], 0);
  // Without real-time scheduling other programs of the machine may take the processor, which nobody witnesses.
  if (report["rt"]["policy"] == "SCHED_FIFO") {
    EXPECT_EQ(report["misses"]["own"], 0) << report["misses"];
  }
  // They did look on.
  EXPECT_TRUE(spy->running()) << spy->err();
  EXPECT_THAT(spy->err(), ::testing::Not(::testing::HasSubstr("xception")));
  EXPECT_GT(std::filesystem::file_size(dir_ / "logger.lcm"), 1'000'000u);
  const std::string steps = watch.out();
  EXPECT_GT(std::count(steps.begin(), steps.end(), '\n'), 10 * rate_hz);
  RecordProperty("misses", report["misses"].dump());
}

INSTANTIATE_TEST_SUITE_P(Rates, WatchedRun, ::testing::Values(10, 100),
                         [](const auto& rate) { return std::to_string(rate.param) + "Hz"; });

}  // namespace
}  // namespace armcmc::test
