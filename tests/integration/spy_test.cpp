#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <regex>
#include <string>

#include "integration/live_pair.hpp"
#include "integration/spy_screen.hpp"

namespace armcmc::test::spy_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Of the panels' palette.
constexpr Rgb kEstimate{0x00, 0x72, 0xB2}, kTruth{0xD5, 0x5E, 0x00}, kInk{0x1B, 0x27, 0x33};
constexpr Rgb kBright{0xFF, 0xFC, 0xCB}, kDark{0x0B, 0x10, 0x26}, kBad{0xB7, 0x1C, 0x1C}, kGood{0x00, 0x79, 0x5A};
constexpr Rgb kCollect{0x56, 0xB4, 0xE9}, kBand{0xD2, 0xE6, 0xF1};

// The list of channels, in the order of their names: the rows and where they are.
constexpr int kFirstRow = 27, kRowHeight = 16;
constexpr int kWidth = 1400, kHeight = 900;
constexpr int kRate = 100;  // Hz

class Spy : public LivePair {
 protected:
  Spy() { prefix_ = "A_"; }  // sorted in front of what LCM sends of itself
  void SetUp() override {
    const std::string missing = SpyScreen::MissingTools();
    if (!missing.empty()) GTEST_SKIP() << missing;
    LivePair::SetUp();
    if (IsSkipped()) return;
    screen_ = std::make_unique<SpyScreen>();
  }

  /// A configuration and a scenario of kRate packs a second.
  void WriteFiles() {
    const std::string period = std::to_string(1000 / kRate);
    std::string config = ShippedConfig();
    config = std::regex_replace(config, std::regex("period_ms = 100"), "period_ms = " + period);
    config = std::regex_replace(config, std::regex("deadline_ms = 100"), "deadline_ms = " + period);
    config = std::regex_replace(config, std::regex("adjust_budget_ms = 80"),
                                "adjust_budget_ms = " + std::to_string(700 / kRate));
    UseConfig(config);
    const std::string scenario = std::regex_replace(Text(scenario_), std::regex("pack_period_s = 0.1"),
                                                    "pack_period_s = " + std::to_string(1.0 / kRate));
    scenario_ = dir_ / "scenario.toml";
    std::ofstream(scenario_) << scenario;
  }

  /// Double click on a row; the panel is put where it hides nothing.
  std::string OpenPanel(const std::string& name, int row, int x, int y) {
    const std::string channel = prefix_ + name;
    screen_->DoubleClick(60, kFirstRow + row * kRowHeight);
    const auto window = screen_->Window(channel + " - ARMCMC");
    EXPECT_TRUE(window) << channel << " has no panel";
    if (window) screen_->Place(*window, x, y, kWidth, kHeight);
    return window.value_or("root");
  }

  static void ExpectNoComplaint(const Process& spy) {
    for (const char* word : {"xception", "Error", "\tat "}) EXPECT_THAT(spy.err(), Not(HasSubstr(word)));
  }

  static void ExpectPosterior(const Picture& p) {
    ASSERT_EQ(p.width, kWidth);
    ASSERT_EQ(p.height, kHeight);
    for (int row = 0; row < 3; ++row) {
      const double top = 0.055 + 0.30 * row;
      const Region density{0.02, top, 0.41, top + 0.28}, map{0.45, top, 0.98, top + 0.28};
      EXPECT_GT(p.Count(kEstimate, density), 300) << "no density of parameter " << row;
      EXPECT_GT(p.Count(kTruth, density), 20) << "no truth of parameter " << row;
      EXPECT_GT(p.Count(kBright, map), 300) << "no ridge of parameter " << row;
      EXPECT_GT(p.Count(kDark, map), 5000) << "no ground of parameter " << row;
      EXPECT_GT(p.Count(kTruth, map), 200) << "no truth over the map of parameter " << row;
    }
  }

  static void ExpectStatus(const Picture& p) {
    const Region charts{0.01, 0.05, 0.62, 1.0}, cards{0.62, 0.05, 1.0, 1.0};
    EXPECT_GT(p.Count(kCollect, charts), 300);
    EXPECT_GT(p.Count(kEstimate, charts), 300);
    EXPECT_GT(p.Count(kBad, charts), 200) << "no deadline";
    EXPECT_GT(p.Count(kGood, cards), 50) << "no slack";
    EXPECT_GT(p.Count(kInk, cards), 3000) << "no numbers";
  }

  static void ExpectEstimate(const Picture& p) {
    for (int row = 0; row < 3; ++row) {
      const double top = 0.055 + 0.21 * row;
      const Region chart{0.07, top, 0.98, top + 0.2};
      EXPECT_GT(p.Count(kBand, chart), 500) << "no band of parameter " << row;
      EXPECT_GT(p.Count(kInk, chart), 100) << "no mean of parameter " << row;
      EXPECT_GT(p.Count(kTruth, chart), 100) << "no truth of parameter " << row;
    }
    EXPECT_GT(p.Count(kEstimate, {0.07, 0.7, 0.98, 0.95}), 500) << "no prediction";
  }

  std::unique_ptr<SpyScreen> screen_;
};

// Everybody looks on: lcm-spy with its three panels, lcm-logger and armcmc-watch.
TEST_F(Spy, ShowsAHundredPacksASecondAndTheEstimatorMissesNothing) {
  WriteFiles();
  auto estimator = StartEstimator();
  auto plant = StartPlant("60");
  Process logger("/usr/bin/env", {"lcm-logger", "--lcm-url=" + bus_->url(), dir_ / "logger.lcm"});
  Process watch(Program("armcmc-watch"), {"--lcm-url", bus_->url(), "--prefix", prefix_, "--json"});
  auto spy = screen_->StartSpy({"--lcm-url", bus_->url()});
  const auto list = screen_->Window("LCM Spy");
  ASSERT_TRUE(list) << spy->err();
  // All six channels of this plant are in the list before anybody clicks.
  const std::size_t before = recorder_->estimates().size();
  ASSERT_TRUE(recorder_->WaitForEstimates(before + static_cast<std::size_t>(3 * kRate)));
  EXPECT_THAT(spy->out(), HasSubstr("Found 7 LCM types"));
  EXPECT_THAT(spy->out(), HasSubstr("Found 3 plugins"));

  const std::string estimate = OpenPanel("EST_ESTIMATE", 1, 1450, 0);
  const std::string posterior = OpenPanel("EST_POSTERIOR", 2, 0, 920);
  const std::string status = OpenPanel("EST_STATUS", 3, 1450, 920);
  const std::size_t opened = recorder_->estimates().size();
  ASSERT_TRUE(recorder_->WaitForEstimates(opened + static_cast<std::size_t>(12 * kRate)));

  // The truth is drawn: a panel hears what stands behind the prefix of its own channel.
  ExpectEstimate(screen_->Shoot(estimate, "estimate"));
  ExpectPosterior(screen_->Shoot(posterior, "posterior"));
  ExpectStatus(screen_->Shoot(status, "status"));
  const Picture channels = screen_->Shoot(*list, "channels");
  EXPECT_GT(channels.Colours({0.0, 0.03, 1.0, 0.18}), 4) << "an empty list";
  EXPECT_TRUE(spy->running());
  ExpectNoComplaint(*spy);

  const Json report = Finish(estimator.get());
  EXPECT_EQ(report["period_ms"], 1000 / kRate);
  EXPECT_GT(report["steps"], 14 * kRate);
  EXPECT_EQ(report["packs"]["lost"], 0);
  // Without real-time scheduling other programs of the machine may take the processor, which nobody witnesses.
  if (report["rt"]["policy"] == "SCHED_FIFO") {
    EXPECT_EQ(report["misses"]["own"], 0) << report["misses"];
  }
  // They did look on.
  EXPECT_GT(std::filesystem::file_size(dir_ / "logger.lcm"), 1'000'000u);
  const std::string steps = watch.out();
  EXPECT_GT(std::count(steps.begin(), steps.end(), '\n'), 10 * kRate);
}

TEST_F(Spy, OpensThePanelsOfAPrefixAtOnce) {
  auto spy = screen_->StartSpy({"--lcm-url", bus_->url(), "--prefix", prefix_});
  for (const char* channel : {"EST_POSTERIOR", "EST_STATUS", "EST_ESTIMATE"})
    EXPECT_TRUE(screen_->Window(prefix_ + channel + " - ARMCMC")) << spy->err();
  ExpectNoComplaint(*spy);
}

}  // namespace
}  // namespace armcmc::test::spy_test
