#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "armcmc/support/csv.hpp"
#include "integration/live_pair.hpp"

namespace armcmc::test::gap_alarm_test {
namespace {

class GapAlarm : public LivePair {};

TEST_F(GapAlarm, RisesForAHiddenEffectAndKeepsTheData) {
  auto estimator = StartEstimator({"--gap-log", dir_ / "logs"});
  ASSERT_EQ(Play("22", {"--hide-effect", "coulomb_friction", "--sealed", dir_ / "truth.json"}), 220u)
      << estimator->err();
  const std::vector<estimator_status_t> statuses = recorder_->statuses();
  const Json report = Finish(estimator.get());

  const estimator_status_t& last = statuses.back();
  EXPECT_EQ(last.gap_watched, 1);
  ASSERT_EQ(last.gap_suspected, 1) << "log evidence " << last.gap_log_evidence;
  EXPECT_GE(last.gap_log_evidence, last.gap_log_threshold);
  EXPECT_GT(last.gap_share, 0.0);
  EXPECT_EQ(last.gap_since_seq, 1);
  EXPECT_LE(last.gap_alarm_seq, 200);
  EXPECT_NE(last.gap_where[0], 0);
  EXPECT_EQ(statuses.front().gap_suspected, 0);

  const Json gap = report["gap"];
  EXPECT_EQ(gap["suspected"], true);
  EXPECT_EQ(gap["alarm_pack"], last.gap_alarm_seq);
  for (const char* stage : {"collect", "adjust", "execute"}) EXPECT_EQ(report["allocations"][stage], 0) << stage;
  ASSERT_TRUE(gap["window"].is_string());
  const auto samples = support::ReadCsv(gap["window"].get<std::string>(), {{"t", "x", "v", "f"}, {}, false});
  EXPECT_EQ(samples.num_rows(), 22'000u) << "all of the run: shorter than window and rest";
  EXPECT_EQ(samples.columns[0].front(), 0.001);
  EXPECT_EQ(samples.columns[0].back(), 22.0);

  // The same packs without threads: the same alarm at the same pack.
  const Outcome replay = RunProgram(
      Program("armcmc-replay"), {"--config", (SourceDir() / "rt/config/hunt_crossley.toml").string(), "--data", Log(),
                                 "--out", dir_ / "replay.csv", "--report", dir_ / "replay.json"});
  ASSERT_EQ(replay.code, 0) << replay.err;
  const Json again = ReadJson(dir_ / "replay.json")["gap"];
  for (const char* key : {"suspected", "where", "log_evidence", "alarm_pack", "since_pack"})
    EXPECT_EQ(again[key], gap[key]) << key;
}

TEST_F(GapAlarm, StaysDownForThePlantThatTheModelDescribes) {
  auto estimator = StartEstimator({"--gap-log", dir_ / "logs"});
  ASSERT_EQ(Play("18"), 180u) << estimator->err();
  const Json gap = Finish(estimator.get())["gap"];
  EXPECT_EQ(gap["suspected"], false);
  EXPECT_EQ(gap["blocks"], 1);
  EXPECT_TRUE(gap["window"].is_null());
  EXPECT_FALSE(std::filesystem::exists(dir_ / "logs"));
}

}  // namespace
}  // namespace armcmc::test::gap_alarm_test
