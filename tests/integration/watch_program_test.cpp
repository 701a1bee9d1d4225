#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <lcm/lcm-cpp.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "armcmc/posterior_t.hpp"
#include "integration/live_pair.hpp"
#include "integration/pty_process.hpp"

namespace armcmc::test::watch_program_test {
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
  Process watch(Program("armcmc-watch"), On({"--json", "--steps", "10"}));
  auto plant = StartPlant("5");
  const Process::Exit exit = watch.Wait(std::chrono::seconds(30));
  EXPECT_EQ(exit.code, 0) << watch.err();
  std::istringstream lines(watch.out());
  int count = 0;
  std::int64_t pack = 0;
  Json step;
  for (std::string line; std::getline(lines, line); ++count) {
    step = Json::Parse(line);
    EXPECT_GT(step["pack"].get<std::int64_t>(), pack);
    pack = step["pack"];
  }
  EXPECT_EQ(count, 10);
  EXPECT_EQ(step["mode"], "contact");
  EXPECT_EQ(step["parameters"]["K"]["truth"], 4.0);
  std::vector<estimate_t> published;
  ASSERT_TRUE(recorder_->WaitUntil([&] {
    published = recorder_->estimates();
    return !published.empty() && published.back().seq >= pack;
  }));
  const auto same = std::find_if(published.begin(), published.end(), [&](const auto& e) { return e.seq == pack; });
  ASSERT_NE(same, published.end());
  EXPECT_EQ(step["parameters"]["K"]["mean"], same->ar_ap[0]);
  EXPECT_GT(step["stage_ms"]["adjust"], 0.0);
  EXPECT_EQ(step["bus"]["foreign"], 0);
}

TEST_F(WatchProgram, WritesOneLineAStepOfItsPrefixWhereThereIsNoTerminal) {
  Process estimator(Program("armcmc-estimator"), On({"--config", config_, "--prefix", "robot/left_"}));
  ASSERT_TRUE(estimator.WaitForErr("waiting for the plant", std::chrono::seconds(20))) << estimator.err();
  auto plant = StartPlant("60", {"--prefix", "robot/left_"});
  const Outcome watch = RunProgram(Program("armcmc-watch"), On({"--prefix", "robot/left_", "--steps", "3"}));
  EXPECT_EQ(watch.code, 0) << watch.err;
  EXPECT_EQ(std::count(watch.out.begin(), watch.out.end(), '\n'), 3);
  EXPECT_THAT(watch.out, HasSubstr("pack "));
  EXPECT_THAT(watch.out, HasSubstr(" of 100 ms"));
  EXPECT_THAT(watch.out, Not(HasSubstr("\x1b")));
  const Outcome other = RunProgram(Program("armcmc-watch"), On({"--prefix", "left_", "--duration", "1"}));
  EXPECT_EQ(other.code, 1) << other.out;
  EXPECT_EQ(other.out, "");
}

TEST_F(WatchProgram, SaysWhatItWaitsForAndWhatCameInsteadAndFails) {
  lcm::LCM bus(bus_->url());
  Process watch(Program("armcmc-watch"), On({"--prefix", "left_", "--duration", "2.5"}));
  const posterior_t wrong{};
  // Until the end of the program: when it begins to listen nobody knows.
  while (watch.running()) {
    bus.publish("left_EST_STATUS", &wrong);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_EQ(watch.Wait(std::chrono::seconds(10)).code, 1);
  EXPECT_THAT(watch.err(), HasSubstr("waiting for left_EST_STATUS on " + bus_->url() +
                                     ": is the estimator running? same URL and prefix?"));
  EXPECT_THAT(watch.err(), HasSubstr("messages of a foreign type"));
  const std::string said = watch.err();
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 2) << "after two seconds, and at the end:\n" << said;
  EXPECT_EQ(watch.out(), "");
}

TEST_F(WatchProgram, DrawsAScreenFollowsItsSizeAndGivesItBack) {
  auto estimator = StartEstimator();
  auto plant = StartPlant("60");
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
}  // namespace armcmc::test::watch_program_test
