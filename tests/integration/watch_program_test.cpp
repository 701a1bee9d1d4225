#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "armcmc/posterior_t.hpp"
#include "integration/live_pair.hpp"
#include "integration/pty_process.hpp"

namespace armcmc::test {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

// What gives a terminal back: line wrap, cursor, the screen that was there before.
constexpr char kRestored[] = "\x1b[?7h\x1b[?25h\x1b[?1049l";

class WatchProgram : public LivePair {
 protected:
  [[nodiscard]] std::vector<std::string> On(std::vector<std::string> more) const {
    more.insert(more.begin(), {"--lcm-url", bus_->url()});
    return more;
  }
};

TEST_F(WatchProgram, WritesOneJsonObjectAStep) {
  auto estimator = StartEstimator();
  Process watch(Program("armcmc-watch"), On({"--json", "--steps", "30"}));
  auto plant = StartPlant("5");
  const Process::Exit exit = watch.Wait(std::chrono::seconds(30));
  EXPECT_EQ(exit.code, 0) << watch.err();
  std::istringstream lines(watch.out());
  int count = 0;
  std::int64_t pack = 0;
  nlohmann::json step;
  for (std::string line; std::getline(lines, line); ++count) {
    step = nlohmann::json::parse(line);
    EXPECT_GT(step["pack"].get<std::int64_t>(), pack);
    pack = step["pack"];
  }
  EXPECT_EQ(count, 30);
  EXPECT_EQ(step["mode"], "contact");
  EXPECT_EQ(step["parameters"]["K"]["truth"], 4.0);
  EXPECT_NEAR(step["parameters"]["K"]["mean"], 4.0, 0.5);
  EXPECT_GT(step["stage_ms"]["adjust"], 0.0);
  EXPECT_EQ(step["bus"]["foreign"], 0);
}

TEST_F(WatchProgram, WritesOneLineAStepWhereThereIsNoTerminal) {
  auto estimator = StartEstimator();
  auto plant = StartPlant("5");
  const Outcome watch = RunProgram(Program("armcmc-watch"), On({"--steps", "3"}));
  EXPECT_EQ(watch.code, 0) << watch.err;
  EXPECT_EQ(std::count(watch.out.begin(), watch.out.end(), '\n'), 3);
  EXPECT_THAT(watch.out, HasSubstr("pack "));
  EXPECT_THAT(watch.out, HasSubstr(" of 100 ms"));
  EXPECT_THAT(watch.out, Not(HasSubstr("\x1b")));
}

TEST_F(WatchProgram, SaysWhatItWaitsForAndFails) {
  const Outcome watch = RunProgram(Program("armcmc-watch"), On({"--prefix", "left_", "--duration", "3"}));
  EXPECT_EQ(watch.code, 1);
  EXPECT_THAT(watch.err, HasSubstr("waiting for left_EST_STATUS on " + bus_->url() +
                                   ": is the estimator running? same URL and prefix?"));
  EXPECT_EQ(watch.out, "");
}

TEST_F(WatchProgram, HearsOnlyItsPrefix) {
  Process estimator(Program("armcmc-estimator"), {"--config", (SourceDir() / "rt/config/hunt_crossley.toml").string(),
                                                  "--lcm-url", bus_->url(), "--prefix", "robot/left_"});
  ASSERT_TRUE(estimator.WaitForErr("waiting for the plant", std::chrono::seconds(20))) << estimator.err();
  auto plant = StartPlant("8", {"--prefix", "robot/left_"});
  const Outcome ours = RunProgram(Program("armcmc-watch"), On({"--prefix", "robot/left_", "--steps", "2"}));
  EXPECT_EQ(ours.code, 0) << ours.err;
  const Outcome other = RunProgram(Program("armcmc-watch"), On({"--prefix", "left_", "--duration", "2"}));
  EXPECT_EQ(other.code, 1) << other.out;
}

TEST_F(WatchProgram, CountsMessagesThatAreNotOurs) {
  lcm::LCM bus(bus_->url());
  Process watch(Program("armcmc-watch"), On({"--duration", "4"}));
  const posterior_t wrong{};
  // Until the end of the program: when it begins to listen nobody knows.
  while (watch.running()) {
    bus.publish("EST_STATUS", &wrong);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_EQ(watch.Wait(std::chrono::seconds(10)).code, 1);
  EXPECT_THAT(watch.err(), HasSubstr("messages of a foreign type"));
}

TEST_F(WatchProgram, DrawsAScreenFollowsItsSizeAndGivesItBack) {
  auto estimator = StartEstimator();
  auto plant = StartPlant("20");
  PtyProcess watch(Program("armcmc-watch"), On({}), 120, 40);
  EXPECT_TRUE(watch.WaitFor("\x1b[?1049h")) << watch.output();
  EXPECT_TRUE(watch.WaitFor("deadline 100 ms")) << watch.output();
  EXPECT_TRUE(watch.WaitFor("N/m^p")) << watch.output();
  EXPECT_TRUE(watch.WaitFor("█")) << watch.output();
  EXPECT_FALSE(watch.TerminalIsAsBefore());
  watch.Resize(120, 3);
  std::string frame;
  for (int i = 0; i < 40; ++i) {  // frames already under way have the old size
    ASSERT_TRUE(watch.WaitFor("\x1b[J"));
    const std::size_t begin = watch.output().rfind("\x1b[H");
    frame = watch.output().substr(begin);
    if (std::count(frame.begin(), frame.end(), '\n') == 2) break;
  }
  EXPECT_EQ(std::count(frame.begin(), frame.end(), '\n'), 2) << frame;
  watch.Type("q");
  EXPECT_EQ(watch.Wait(), 0);
  EXPECT_THAT(watch.output(), EndsWith(kRestored));
  EXPECT_TRUE(watch.TerminalIsAsBefore());
}

TEST_F(WatchProgram, GivesTheTerminalBackOnControlC) {
  PtyProcess watch(Program("armcmc-watch"), On({"--ascii"}), 100, 30);
  EXPECT_TRUE(watch.WaitFor("! ")) << watch.output();
  EXPECT_TRUE(watch.WaitFor("waiting for EST_STATUS")) << watch.output();
  watch.Type("\x03");
  EXPECT_EQ(watch.Wait(), 0);
  EXPECT_THAT(watch.output(), EndsWith(kRestored));
  EXPECT_TRUE(watch.TerminalIsAsBefore());
}

TEST(WatchArguments, AreChecked) {
  for (const std::vector<std::string>& bad : std::vector<std::vector<std::string>>{
           {"--lcm-url", "http://x"}, {"--steps", "0"}, {"--duration", "-1"}, {"--nonsense"}}) {
    const Outcome o = RunProgram(Program("armcmc-watch"), bad);
    EXPECT_EQ(o.code, 2) << bad[0];
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  }
  EXPECT_EQ(RunProgram(Program("armcmc-watch"), {"--help"}).code, 0);
}

}  // namespace
}  // namespace armcmc::test
