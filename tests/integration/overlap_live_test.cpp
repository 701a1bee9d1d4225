// Packs that overlap: a posterior every 10 ms of windows of 100 ms.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "armcmc/estimate_t.hpp"
#include "integration/live_pair.hpp"

namespace armcmc::test::overlap_live_test {
namespace {

constexpr std::size_t kOverlap = 10;

class OverlapLive : public LivePair {
 protected:
  OverlapLive() {
    config_ = SourceDir() / "rt/config/hunt_crossley_100hz.toml";
    scenario_ = SourceDir() / "plant_sim/scenarios/hunt_crossley_100hz.toml";
  }

  /// A replay of what is asked for, as a table of text.
  std::string Replay(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--config", config_, "--out", dir_ / "replay.csv"});
    const Outcome o = RunProgram(Program("armcmc-replay"), arguments);
    EXPECT_EQ(o.code, 0) << o.out << o.err;
    return Text(dir_ / "replay.csv");
  }
};

TEST_F(OverlapLive, ThreeSecondsAtAHundredHertzLoseNothingCoverTheTruthAndReplayToTheBit) {
  auto estimator = StartEstimator();
  auto plant = StartPlant("3");
  ASSERT_EQ(plant->Wait(std::chrono::seconds(60)).code, 0) << plant->err();
  constexpr std::size_t kPacks = 291;  // the first at 0.1 s
  const bool all = recorder_->WaitForEstimates(kPacks);
  const Json report = Finish(estimator.get());
  EXPECT_EQ(report["packs"]["received"], kPacks);
  EXPECT_EQ(report["packs"]["lost"], 0);
  EXPECT_EQ(report["packs"]["rejected"], 0);
  for (const char* stage : {"collect", "adjust", "execute"}) EXPECT_EQ(report["allocations"][stage], 0) << stage;
  if (!all && report["packs"]["dropped"] > 0 && report["misses"]["own"] == 0)
    GTEST_SKIP() << "the machine stood still, and " << report["packs"]["dropped"] << " packs were given up";
  ASSERT_TRUE(all) << estimator->err();
  EXPECT_EQ(report["steps"], kPacks);
  for (const char* from : {"from_arrival", "from_last_sample"})
    EXPECT_EQ(report["published_ms"][from]["count"], kPacks) << from;
  EXPECT_LE(report["published_ms"]["from_arrival"]["p50"], report["published_ms"]["from_last_sample"]["p50"]);

  const std::vector<estimate_t> live = recorder_->estimates();
  ASSERT_EQ(live.size(), kPacks);
  constexpr double kTruth[] = {4.0, 2.3, 1.7};
  for (std::size_t k = kPacks - kOverlap; k < kPacks; ++k)  // the newest of every recursion
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT(std::fabs(live[k].ar_ap[i] - kTruth[i]), 4.5 * live[k].sd[i]) << live[k].seq << ", parameter " << i;
    }
  for (std::size_t k = 1; k < kPacks; ++k) EXPECT_NEAR(live[k].t_last_s - live[k - 1].t_last_s, 0.01, 1e-9);

  const Outcome verified = RunProgram(Program("armcmc-replay"), {"--data", Log(), "--config", config_, "--verify"});
  EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
  EXPECT_NE(verified.out.find("are bit-identical"), std::string::npos) << verified.out;

  // The same plant without a bus, as fast as possible: its CSV has every sample once, and gives the same packs.
  const Outcome offline = RunProgram(Program("armcmc-plant"), {"--scenario", scenario_.string(), "--seed", seed_,
                                                               "--duration", "3", "--csv", dir_ / "offline.csv"});
  ASSERT_EQ(offline.code, 0) << offline.err;
  // The packs 1, 11, .. 291 are those of a plant whose packs do not overlap: as many samples, and as sure an estimate.
  // Whoever counted all samples of all packs would be three times as sure.
  const Outcome plain =
      RunProgram(Program("armcmc-replay"), {"--config", (SourceDir() / "rt/config/hunt_crossley.toml").string(),
                                            "--data", dir_ / "offline.csv", "--out", dir_ / "plain.csv"});
  ASSERT_EQ(plain.code, 0) << plain.err;
  Table without_overlap = ReadTable(dir_ / "plain.csv");
  ASSERT_EQ(without_overlap["pack"].back(), "30");
  for (int i = 0; i < 3; ++i) {
    const std::string name = i == 0 ? "K" : i == 1 ? "B" : "p";
    const double sd = std::strtod(without_overlap[name + "_sd"].back().c_str(), nullptr);
    EXPECT_NEAR(live.back().sd[i] / sd, 1.0, 0.2) << name;
    EXPECT_NEAR(live.back().ar_ap[i], std::strtod(without_overlap[name + "_ap"].back().c_str(), nullptr), 0.5 * sd)
        << name;
  }
  const std::string from_log = Replay({"--data", Log()});
  EXPECT_EQ(from_log, Replay({"--data", Log()})) << "the same every time";
  EXPECT_EQ(from_log, Replay({"--data", dir_ / "offline.csv", "--draws-from", Log()}));
}

TEST_F(OverlapLive, PacksThatTheOverlapDoesNotDivideAreRejectedAndCounted) {
  UseConfig("schema = 1\n[model]\nname = \"hunt_crossley\"\n[timing]\nperiod_ms = 100\noverlap = 3\n");
  scenario_ = SourceDir() / "plant_sim/scenarios/hunt_crossley_paper.toml";
  auto estimator = StartEstimator();
  auto plant = StartPlant("0.5");
  ASSERT_EQ(plant->Wait(std::chrono::seconds(60)).code, 0) << plant->err();
  const Json report = Finish(estimator.get());
  EXPECT_EQ(report["packs"]["received"], 0);
  EXPECT_EQ(report["packs"]["rejected"], 5);
  EXPECT_EQ(report["packs"]["rejected_by_cause"]["n_samples is not a multiple of timing.overlap"], 5);
  EXPECT_EQ(report["steps"], 0);
}

TEST_F(OverlapLive, EveryRecursionGoesOnFromWhatItHadLearnt) {
  const std::string file = dir_ / "learnt.snapshot";
  auto first = StartEstimator({"--resume", file});
  auto plant = StartPlant("1");
  ASSERT_EQ(plant->Wait(std::chrono::seconds(60)).code, 0) << plant->err();
  ASSERT_TRUE(recorder_->WaitForEstimates(2 * kOverlap)) << first->err();
  first->Signal(SIGINT);
  EXPECT_EQ(first->Wait(std::chrono::seconds(30)).code, 0) << first->err();
  const std::size_t before = recorder_->estimates().size();

  auto second = StartEstimator({"--resume", file});
  auto again = StartPlant("1");
  ASSERT_EQ(again->Wait(std::chrono::seconds(60)).code, 0) << again->err();
  ASSERT_TRUE(recorder_->WaitForEstimates(before + kOverlap)) << second->err();
  const Json report = Finish(second.get());
  EXPECT_GT(report["snapshot"]["resumed_from_pack"], 0);
  EXPECT_GT(report["snapshot"]["written"], 0);
  EXPECT_EQ(report["snapshot"]["failed"], 0);
  for (const char* stage : {"collect", "adjust", "execute"}) EXPECT_EQ(report["allocations"][stage], 0) << stage;
  const std::vector<estimate_t> live = recorder_->estimates();
  for (std::size_t k = before; k < before + kOverlap; ++k)
    EXPECT_EQ(live[k].known, 1) << "from the first word of every recursion on: " << k - before;
}

}  // namespace
}  // namespace armcmc::test::overlap_live_test
