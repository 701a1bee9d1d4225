// Files of earlier versions, and of later ones: .github/CONTRIBUTING.md, "What a newer program reads".

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "armcmc/estimate_t.hpp"
#include "integration/live_pair.hpp"
#include "tools/csv_rows.hpp"
#include "tools/file_text.hpp"

namespace armcmc::test::compatibility_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

double Number(const std::string& text) { return std::strtod(text.c_str(), nullptr); }

fs::path Kept(const std::string& name) { return SourceDir() / "tests/integration/compatibility/0.1.0" / name; }

/// Of a compressed one.
std::string KeptContent(const std::string& name) {
  const Outcome o = RunProgram("/bin/gzip", {"-dc", Kept(name + ".gz")});
  EXPECT_EQ(o.code, 0) << o.err;
  return o.out;
}

class Version010 : public LivePair {
 protected:
  Version010() {
    std::ofstream(dir_ / "kept.lcm", std::ios::binary) << KeptContent("run.lcm");
    std::ofstream(Snapshot(), std::ios::binary) << KeptContent("learnt.snapshot");
    config_ = Kept("config.toml");
  }
  [[nodiscard]] std::string Snapshot() const { return dir_ / "learnt.snapshot"; }
  [[nodiscard]] std::vector<std::string> OfLog(std::vector<std::string> more) const {
    more.insert(more.begin(),
                {"--data", dir_ / "kept.lcm", "--model", Kept("plant.toml"), "--config", Kept("config.toml")});
    return more;
  }
  /// Sends the packs of the log, without what was answered.
  std::size_t PlayPacks() {
    {
      lcm::LogFile all((dir_ / "kept.lcm").string(), "r"), packs((dir_ / "packs.lcm").string(), "w");
      while (const lcm::LogEvent* event = all.readNextEvent()) {
        lcm::LogEvent copy = *event;
        if (event->channel == "PLANT_PACK_V2") packs.writeEvent(&copy);
      }
    }
    return PlayLog(dir_ / "packs.lcm");
  }
  /// Rows of a channel of the log.
  std::vector<std::map<std::string, std::string>> Exported(const std::string& channel) {
    const Outcome o = RunProgram(Program("armcmc-export"), {"--data", dir_ / "kept.lcm", "--out", dir_ / "tables"});
    EXPECT_EQ(o.code, 0) << o.err;
    return RowsOf(TextOf(dir_ / ("tables/" + channel + ".csv")));
  }
};

TEST_F(Version010, TheLogIsExportedToTheBit) {
  const auto packs = Exported("PLANT_PACK_V2"), estimates = Exported("EST_ESTIMATE");
  ASSERT_EQ(packs.size(), 300u);
  EXPECT_EQ(packs[0].at("u [V]"), "0.9018105030568324");
  EXPECT_EQ(packs[299].at("w [rad s^-1]"), "-3.7969351223720085");
  ASSERT_EQ(estimates.size(), 3u);
  EXPECT_EQ(estimates[2].at("ar_map.gain [rad (s V)^-1]"), "11.981215243014711");
  EXPECT_EQ(estimates[2].at("sd.tau [s]"), "0.0013515635821686476");
  EXPECT_EQ(Exported("EST_POSTERIOR").size(), 3u);
  EXPECT_EQ(Exported("EST_CHANGE").size(), 3u);
}

// Between two versions the arithmetic may differ, and with it the draws: what the posterior says may not. The recorded
// posteriors have at least 328 effective draws, so that the means of two runs differ by sqrt(2 / 328) = 0.078 posterior
// standard deviations, and medians by 1.25 times as much: 0.4 is four of these.
TEST_F(Version010, TheLogIsReplayedToTheSamePosterior) {
  const Outcome o =
      RunProgram(Program("armcmc-replay"), OfLog({"--out", dir_ / "estimates.csv", "--report", dir_ / "report.json"}));
  ASSERT_EQ(o.code, 0) << o.err;
  const auto now = RowsOf(TextOf(dir_ / "estimates.csv")), then = Exported("EST_ESTIMATE");
  ASSERT_EQ(now.size(), 3u);
  ASSERT_EQ(then.size(), 3u);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_EQ(now[n].at("draws"), "3000") << "as the configuration says";
    for (const auto& [parameter, unit] : {std::pair{"gain", " [rad (s V)^-1]"}, {"tau", " [s]"}}) {
      const std::string name = parameter, column = name + unit;
      const auto recorded = [&](const char* what) {
        return Number(then[n].at(std::string(what).append(".").append(column)));
      };
      const auto computed = [&](const char* what) { return Number(now[n].at(std::string(name).append(what))); };
      const double sd = recorded("sd");
      EXPECT_NEAR(computed("_ap"), recorded("ar_ap"), 0.4 * sd) << parameter << " " << n;
      EXPECT_NEAR(computed("_sd") / sd, 1.0, 0.3) << parameter << " " << n;
      EXPECT_NEAR(computed("_q50"), recorded("q50"), 0.4 * sd) << parameter << " " << n;
    }
  }
}

TEST_F(Version010, TheLogIsComparedMessageByMessage) {
  const Outcome o = RunProgram(Program("armcmc-replay"), OfLog({"--verify"}));
  // 1: the arithmetic differs, and the first difference is named.
  EXPECT_THAT(o.code, ::testing::AnyOf(0, 1)) << o.err;
  if (o.code == 0)
    EXPECT_THAT(o.out, HasSubstr("verified: 9 recorded messages are bit-identical"));
  else
    EXPECT_THAT(o.out + o.err, HasSubstr("differ"));
}

TEST_F(Version010, TheRecordingIsRead) {
  const Outcome o =
      RunProgram(Program("armcmc-replay"), {"--recording", Kept("recording.toml"), "--out", dir_ / "estimates.csv"});
  ASSERT_EQ(o.code, 0) << o.err;
  const auto rows = RowsOf(TextOf(dir_ / "estimates.csv"));
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_NEAR(Number(rows[0].at("gain")), 11.91, 0.1) << "1.5 posterior standard deviations";
  EXPECT_NEAR(Number(rows[0].at("tau")), 0.198, 0.003);
}

TEST_F(Version010, TheScenarioMovesThePlant) {
  const Outcome o = RunProgram(Program("armcmc-plant"), {"--model", Kept("plant.toml"), "--scenario",
                                                         Kept("scenario.toml"), "--csv", dir_ / "motor.csv"});
  ASSERT_EQ(o.code, 0) << o.err;
  const auto now = RowsOf(TextOf(dir_ / "motor.csv")), then = RowsOf(TextOf(Kept("motor.csv")));
  ASSERT_EQ(now.size(), 300u);
  for (std::size_t n = 0; n < then.size(); ++n)
    EXPECT_NEAR(Number(now[n].at("w")), Number(then[n].at("w")), 1e-9) << n << ": noise and motion of the same seed";
}

TEST_F(Version010, TheResultOfTheGapWorkflowIsListed) {
  fs::create_directories(dir_ / "gaps/motor");
  fs::copy_file(Kept("result.json"), dir_ / "gaps/motor/result.json");
  std::ofstream(dir_ / "gaps/motor/report.html") << "<html></html>";
  const Outcome o = RunProgram(Program("armcmc-gap"), {"--gallery", dir_ / "gaps"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(TextOf(dir_ / "gaps/index.html"), AllOf(HasSubstr("motor.csv"), HasSubstr("nothing is missing")));
}

TEST_F(Version010, TheSnapshotIsGoneOnFrom) {
  const double learnt = Number(Exported("EST_ESTIMATE").at(2).at("sd.gain [rad (s V)^-1]"));
  auto estimator = StartEstimator({"--model", Kept("plant.toml"), "--resume", Snapshot()});
  EXPECT_TRUE(estimator->WaitForErr("continuing from pack 3 in the snapshot", 5s)) << estimator->err();
  ASSERT_EQ(PlayPacks(), 3u) << estimator->err();
  const estimate_t first = recorder_->estimates().front();
  EXPECT_EQ(first.known, 1);
  EXPECT_EQ(first.decision, estimate_t::DECISION_REINFORCEMENT) << "who knows nothing starts with a modification";
  EXPECT_LT(first.sd[0], 1.25 * learnt) << "of one pack alone it would be sqrt(3) times as wide";
  EXPECT_NEAR(first.ar_ap[0], 11.98, 4.0 * learnt);
  EXPECT_EQ(Finish(estimator.get())["snapshot"]["resumed_from_pack"], 3);
}

TEST_F(Version010, ASnapshotOfANewerVersionIsRefusedAndStays) {
  std::string newer = KeptContent("learnt.snapshot");
  newer[8] = 99;
  std::ofstream(Snapshot(), std::ios::binary) << newer;
  auto estimator = StartEstimator({"--model", Kept("plant.toml"), "--resume", Snapshot()});
  EXPECT_TRUE(estimator->WaitForErr("learnt.snapshot is refused, it has version 99 of a newer program", 5s))
      << estimator->err();
  EXPECT_THAT(estimator->err(), HasSubstr("starting afresh, it is kept as " + Snapshot() + ".refused"));
  ASSERT_EQ(PlayPacks(), 3u) << estimator->err();
  (void)Finish(estimator.get());
  EXPECT_EQ(TextOf(Snapshot() + ".refused"), newer) << "what was learnt";
  EXPECT_NE(TextOf(Snapshot()), newer) << "what this program has learnt";
}

TEST_F(Version010, AFileOfANewerFormatIsRefusedInOneLineThatSaysSo) {
  const auto newer = [&](const std::string& name) {
    std::string text = TextOf(Kept(name));
    text.replace(text.find("schema"), text.find('\n', text.find("schema")) - text.find("schema"),
                 "schema = 2\nsomething_new = true");
    std::ofstream(dir_ / name) << text;
    return dir_ / name;
  };
  struct Case {
    const char* program;
    std::vector<std::string> arguments;
    std::string file;
  };
  const std::string data = dir_ / "kept.lcm", plant = newer("plant.toml"), config = newer("config.toml"),
                    scenario = newer("scenario.toml"), out = dir_ / "estimates.csv";
  fs::create_directories(dir_ / "other");
  std::string recording = TextOf(Kept("recording.toml"));
  recording.replace(recording.find("schema = 1"), 10, "schema = 2");
  std::ofstream(dir_ / "other/recording.toml") << recording;
  fs::copy_file(Kept("plant.toml"), dir_ / "other/plant.toml");
  fs::copy_file(Kept("motor.csv"), dir_ / "other/motor.csv");
  const std::vector<Case> cases = {
      {"armcmc-model", {"check", plant}, "plant.toml"},
      {"armcmc-replay", {"--data", data, "--model", plant, "--out", out}, "plant.toml"},
      {"armcmc-plant", {"--model", plant, "--csv", dir_ / "a.csv"}, "plant.toml"},
      {"armcmc-gap", {"--model", plant, "--data", Kept("motor.csv"), "--out", dir_ / "gap"}, "plant.toml"},
      {"armcmc-estimator", {"--model", plant}, "plant.toml"},
      {"armcmc-replay",
       {"--data", data, "--model", Kept("plant.toml"), "--config", config, "--out", out},
       "config.toml"},
      {"armcmc-estimator", {"--model", Kept("plant.toml"), "--config", config}, "config.toml"},
      {"armcmc-plant",
       {"--model", Kept("plant.toml"), "--scenario", scenario, "--csv", dir_ / "a.csv"},
       "scenario.toml"},
      {"armcmc-replay", {"--recording", dir_ / "other/recording.toml", "--out", out}, "recording.toml"},
      {"armcmc-plant", {"--recording", dir_ / "other/recording.toml"}, "recording.toml"},
      {"armcmc-gap", {"--recording", dir_ / "other/recording.toml", "--out", dir_ / "gap"}, "recording.toml"},
  };
  for (const Case& c : cases) {
    const Outcome o = RunProgram(Program(c.program), c.arguments, 20s);
    EXPECT_EQ(o.code, 2) << c.program << " " << c.file << ": " << o.out << o.err;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_THAT(o.err, HasSubstr(c.file + ":")) << c.program;
    EXPECT_THAT(o.err, HasSubstr("schema = 2: expected 1; the file is of a newer version of the program")) << c.program;
  }
}

TEST_F(Version010, AResultOfANewerFormatIsRefused) {
  fs::create_directories(dir_ / "gaps/motor");
  std::string text = TextOf(Kept("result.json"));
  text.replace(text.find("\"schema\": 1"), 11, "\"schema\": 2");
  std::ofstream(dir_ / "gaps/motor/result.json") << text;
  std::ofstream(dir_ / "gaps/motor/report.html") << "<html></html>";
  const Outcome o = RunProgram(Program("armcmc-gap"), {"--gallery", dir_ / "gaps"});
  EXPECT_EQ(o.code, 2);
  EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  EXPECT_THAT(o.err, HasSubstr("result.json: schema = 2: expected 1; the file is of a newer version of the program"));
}

TEST_F(Version010, MessagesOfANewerTypeAreCountedAndTheRestIsRead) {
  std::string log = KeptContent("run.lcm");
  // The eight bytes behind the channel are the fingerprint.
  const std::string channel = "EST_ESTIMATE";
  int changed = 0;
  for (std::size_t at = log.find(channel); at != std::string::npos; at = log.find(channel, at + 1), ++changed)
    log[at + channel.size()] = static_cast<char>(log[at + channel.size()] ^ 1);
  ASSERT_EQ(changed, 3);
  std::ofstream(dir_ / "kept.lcm", std::ios::binary) << log;
  EXPECT_EQ(Exported("PLANT_PACK_V2").size(), 300u);
  const Outcome o = RunProgram(Program("armcmc-export"), {"--data", dir_ / "kept.lcm", "--out", dir_ / "tables"});
  EXPECT_THAT(
      o.out,
      HasSubstr("foreign: EST_ESTIMATE, 3 events of type 2c3f65e4c6443a48 (not a released type of this project)"));
  const Outcome replay = RunProgram(Program("armcmc-replay"), OfLog({"--out", dir_ / "estimates.csv"}));
  ASSERT_EQ(replay.code, 0) << replay.err;
  EXPECT_EQ(RowsOf(TextOf(dir_ / "estimates.csv")).size(), 3u);
}

}  // namespace
}  // namespace armcmc::test::compatibility_test
