#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "integration/live_pair.hpp"
#include "integration/spy_screen.hpp"

namespace armcmc::test {
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

class Spy : public LivePair {
 protected:
  void SetUp() override {
    const std::string missing = SpyScreen::MissingTools();
    if (!missing.empty()) GTEST_SKIP() << missing;
    LivePair::SetUp();
    if (IsSkipped()) return;
    screen_ = std::make_unique<SpyScreen>();
  }

  /// Double click on a row; the panel is put where it hides nothing.
  std::string OpenPanel(const std::string& channel, int row, int x, int y) {
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

TEST_F(Spy, DecodesTheChannelsAndOpensPanelsByDoubleClick) {
  auto estimator = StartEstimator();
  auto plant = StartPlant("60");
  auto spy = screen_->StartSpy({"--lcm-url", bus_->url()});
  const auto list = screen_->Window("LCM Spy");
  ASSERT_TRUE(list) << spy->err();
  // All five channels are in the list before anybody clicks.
  const std::size_t before = recorder_->estimates().size();
  ASSERT_TRUE(recorder_->WaitForEstimates(before + 30));
  EXPECT_THAT(spy->out(), HasSubstr("Found 5 LCM types"));
  EXPECT_THAT(spy->out(), HasSubstr("Found 3 plugins"));

  const std::string estimate = OpenPanel("EST_ESTIMATE", 0, 1450, 0);
  const std::string posterior = OpenPanel("EST_POSTERIOR", 1, 0, 920);
  const std::string status = OpenPanel("EST_STATUS", 2, 1450, 920);
  const std::size_t opened = recorder_->estimates().size();
  ASSERT_TRUE(recorder_->WaitForEstimates(opened + 120));

  ExpectEstimate(screen_->Shoot(estimate, "estimate"));
  ExpectPosterior(screen_->Shoot(posterior, "posterior"));
  ExpectStatus(screen_->Shoot(status, "status"));
  const Picture channels = screen_->Shoot(*list, "channels");
  EXPECT_GT(channels.Colours({0.0, 0.03, 1.0, 0.18}), 4) << "an empty list";
  EXPECT_TRUE(spy->running());
  ExpectNoComplaint(*spy);

  // Somebody looked on, and nothing happened to the estimator.
  const nlohmann::json report = Finish(estimator.get());
  if (report["rt"]["policy"] == "SCHED_FIFO") {
    EXPECT_EQ(report["misses"]["own"], 0);
  }
}

TEST_F(Spy, PanelsFollowThePrefix) {
  Process estimator(Program("armcmc-estimator"), {"--config", (SourceDir() / "rt/config/hunt_crossley.toml").string(),
                                                  "--lcm-url", bus_->url(), "--prefix", "left_"});
  auto plant = StartPlant("40", {"--prefix", "left_"});
  auto spy = screen_->StartSpy({"--lcm-url", bus_->url(), "--prefix", "left_"});
  const auto posterior = screen_->Window("left_EST_POSTERIOR - ARMCMC");
  ASSERT_TRUE(posterior) << spy->err();
  const auto status = screen_->Window("left_EST_STATUS - ARMCMC");
  const auto estimate = screen_->Window("left_EST_ESTIMATE - ARMCMC");
  ASSERT_TRUE(status && estimate);
  screen_->Place(*estimate, 1450, 0, kWidth, kHeight);
  screen_->Place(*posterior, 0, 920, kWidth, kHeight);
  screen_->Place(*status, 1450, 920, kWidth, kHeight);
  std::this_thread::sleep_for(std::chrono::seconds(12));
  // The truth is drawn, so PLANT_TRUTH was heard behind the same prefix.
  ExpectPosterior(screen_->Shoot(*posterior, "left_posterior"));
  ExpectStatus(screen_->Shoot(*status, "left_status"));
  ExpectEstimate(screen_->Shoot(*estimate, "left_estimate"));
  ExpectNoComplaint(*spy);
}

}  // namespace
}  // namespace armcmc::test
