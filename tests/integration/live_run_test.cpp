#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "armcmc/estimate_t.hpp"
#include "integration/live_pair.hpp"

namespace armcmc::test::live_run_test {
namespace {

double Value(const std::string& text) { return text.empty() ? 0.0 : std::strtod(text.c_str(), nullptr); }

/// Every number that the live run published, against the one that the replay computed: equal, not near.
void ExpectEqualToTheBit(const std::vector<estimate_t>& live, Table& replay) {
  ASSERT_EQ(replay["pack"].size(), live.size());
  int differences = 0;
  for (std::size_t row = 0; row < live.size(); ++row) {
    const estimate_t& e = live[row];
    ASSERT_EQ(std::to_string(e.seq), replay["pack"][row]);
    const auto check = [&](const std::string& column, double value) {
      if (Value(replay[column][row]) == value) return;
      if (++differences <= 10)
        ADD_FAILURE() << "pack " << e.seq << ", " << column << ": live " << value << ", replay " << replay[column][row];
    };
    for (int i = 0; i < e.n_params; ++i) {
      const std::string name(reinterpret_cast<const char*>(e.param_name[i]));  // zero padded characters
      check(name, e.ar_map[i]);
      check(name + "_ap", e.ar_ap[i]);
      check(name + "_sd", e.sd[i]);
      check(name + "_q025", e.q025[i]);
      check(name + "_q50", e.q50[i]);
      check(name + "_q975", e.q975[i]);
    }
    check("draws", e.draws);
    if (e.decision == estimate_t::DECISION_HOLD) continue;
    check("lambda", e.lambda);
    check("zeta", e.zeta);
    check("ess", e.ess);
    check("kish_ess", e.kish_ess);
    check("acceptance", e.acceptance);
    check("log_evidence", e.log_evidence);
    check("p_changed", e.p_changed);
  }
  EXPECT_EQ(differences, 0);
}

class LiveRun : public LivePair {
 protected:
  /// Every pack of the plant has its estimate, or the test is over: skipped, when the machine stood still for longer
  /// than a period, so that packs had to be given up, and failed else.
  void WaitForAll(std::size_t count, Process* estimator) {
    if (recorder_->WaitForEstimates(count)) return;
    const Json report = Finish(estimator);
    if (report["packs"]["dropped"] > 0 && report["misses"]["own"] == 0 && report["misses"]["machine"] > 0)
      GTEST_SKIP() << "the machine stood still, and " << report["packs"]["dropped"] << " packs were given up";
    FAIL() << "estimates are missing\n" << estimator->err();
  }

  Table Replay(const std::vector<std::string>& data_arguments) {
    std::vector<std::string> arguments = {"--config", (SourceDir() / "rt/config/hunt_crossley.toml").string(), "--out",
                                          dir_ / "replay.csv"};
    arguments.insert(arguments.end(), data_arguments.begin(), data_arguments.end());
    const Outcome o = RunProgram(Program("armcmc-replay"), arguments);
    EXPECT_EQ(o.code, 0) << o.err;
    return ReadTable(dir_ / "replay.csv");
  }
};

// Long enough to lose the contact, at 3.9 s, and to come back to what was learnt in it, at 6 s.
TEST_F(LiveRun, EightSecondsMeetEveryDeadlineAndReplayToTheBit) {
  auto estimator = StartEstimator();
  auto plant = StartPlant("8");
  ASSERT_EQ(plant->Wait(std::chrono::seconds(60)).code, 0) << plant->err();
  WaitForAll(80, estimator.get());
  if (IsSkipped() || HasFatalFailure()) return;
  const Json report = Finish(estimator.get());

  EXPECT_EQ(report["packs"]["received"], 80);
  EXPECT_EQ(report["packs"]["lost"], 0);
  EXPECT_EQ(report["packs"]["rejected"], 0);
  EXPECT_EQ(report["steps"], 80);
  for (const char* stage : {"collect", "adjust", "execute"}) {
    EXPECT_EQ(report["allocations"][stage], 0) << stage;
  }
  // Without real-time scheduling other programs of the machine may take the processor, which nobody witnesses.
  if (report["rt"]["policy"] == "SCHED_FIFO") {
    EXPECT_EQ(report["misses"]["own"], 0);
  }
  const std::vector<estimate_t> live = recorder_->estimates();
  ASSERT_EQ(live.size(), 80u);
  EXPECT_NEAR(live.back().ar_map[0], 4.0, 0.2);
  EXPECT_NEAR(live.back().ar_map[1], 2.3, 0.2);
  EXPECT_NEAR(live.back().ar_map[2], 1.7, 0.03);

  Table from_log = Replay({"--data", Log()});
  ExpectEqualToTheBit(live, from_log);

  // The same plant without a bus, as fast as possible: the same samples, so the same estimates.
  const Outcome offline = RunProgram(
      Program("armcmc-plant"), {"--scenario", (SourceDir() / "plant_sim/scenarios/hunt_crossley_paper.toml").string(),
                                "--seed", seed_, "--duration", "8", "--csv", dir_ / "offline.csv"});
  ASSERT_EQ(offline.code, 0) << offline.err;
  Table from_csv = Replay({"--data", dir_ / "offline.csv", "--draws-from", Log()});
  ExpectEqualToTheBit(live, from_csv);
}

TEST_F(LiveRun, ALogOfLcmLoggerIsVerifiedToTheBit) {
  const std::filesystem::path logger = "/usr/bin/lcm-logger";
  if (!std::filesystem::exists(logger)) GTEST_SKIP() << "needs lcm-logger: apt-get install liblcm-bin";
  const std::string log = dir_ / "logger.lcm";
  Process recording(logger, {"--lcm-url=" + bus_->url(), log});
  // It says nothing when it is ready: traffic in its file does.
  auto estimator = StartEstimator();
  ASSERT_TRUE(recorder_->WaitUntil([&log] {
    std::error_code none;
    return std::filesystem::exists(log, none) && std::filesystem::file_size(log, none) > 0;
  })) << recording.err();
  auto plant = StartPlant("3");
  ASSERT_EQ(plant->Wait(std::chrono::seconds(60)).code, 0) << plant->err();
  WaitForAll(30, estimator.get());
  if (IsSkipped() || HasFatalFailure()) return;
  // It drops what it has not written when it is stopped; the health of the estimator goes on behind the estimates.
  const auto size = std::filesystem::file_size(log);
  ASSERT_TRUE(recorder_->WaitUntil([&log, size] { return std::filesystem::file_size(log) > size; }));
  Finish(estimator.get());
  recording.Signal(SIGINT);
  recording.Wait(std::chrono::seconds(10));

  const std::vector<std::string> verify = {"--data", log, "--config",
                                           (SourceDir() / "rt/config/hunt_crossley.toml").string(), "--verify"};
  const Outcome o = RunProgram(Program("armcmc-replay"), verify);
  EXPECT_EQ(o.code, 0) << o.out << o.err;
  EXPECT_NE(o.out.find("verified: 90 recorded messages are bit-identical"), std::string::npos) << o.out;
}

}  // namespace
}  // namespace armcmc::test::live_run_test
