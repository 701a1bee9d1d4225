// armcmc-plant as a process on a bus of its own, with a stand-in estimator in this process.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <csignal>
#include <cstring>
#include <fstream>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/estimate_t.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "process.hpp"
#include "support/paths.hpp"

namespace armcmc::plant_sim {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Answers packs with the paper's true parameters, while `answers` says so.
class StandIn {
 public:
  StandIn(const std::string& url, std::function<bool(std::int64_t)> answers) : bus_(url), answers_(std::move(answers)) {
    bus_.subscribeFunction("PLANT_PACK", &StandIn::OnPack, this);
  }

  void RunWhile(Process* process) {
    while (process->Running()) bus_.handleTimeout(20);
  }

  std::set<std::int64_t> seqs, run_ids;

 private:
  static void OnPack(const lcm::ReceiveBuffer*, const std::string&, const data_pack_t* pack, StandIn* self) {
    self->seqs.insert(pack->seq);
    self->run_ids.insert(pack->run_id);
    if (!self->answers_(pack->seq)) return;
    estimate_t estimate{};
    estimate.seq = pack->seq;
    estimate.run_id = pack->run_id;
    estimate.plant_kind = pack->plant_kind;
    estimate.known = estimate.known_by_mode[0] = 1;
    estimate.n_modes = 1;
    estimate.n_params = 3;
    const char* names[] = {"K", "B", "p"};
    const double theta[] = {4.0, 2.3, 1.7};
    for (int i = 0; i < 3; ++i) {
      std::memcpy(estimate.param_name[i], names[i], 1);
      estimate.ar_map_by_mode[0][i] = theta[i];
      estimate.q025[i] = theta[i] - 0.1;
      estimate.q975[i] = theta[i] + 0.1;
    }
    self->bus_.publish("EST_ESTIMATE", &estimate);
    estimate.run_id += 1;  // an answer to someone else
    self->bus_.publish("EST_ESTIMATE", &estimate);
    estimator_status_t status{};
    status.missed_own = 2;
    status.degraded_flags = estimator_status_t::DEGRADED_NO_FIFO;
    self->bus_.publish("EST_STATUS", &status);
  }

  lcm::LCM bus_;
  std::function<bool(std::int64_t)> answers_;
};

nlohmann::json ReadJson(const std::filesystem::path& path) {
  std::ifstream file(path);
  return nlohmann::json::parse(file);
}

TEST(LivePlant, ScoresAPerfectEstimatorAsPerfect) {
  ARMCMC_REQUIRE_MULTICAST();
  const test::TestBus bus;
  const test::ScratchDir folder;
  StandIn estimator(bus.url(), [](std::int64_t) { return true; });
  Process plant(test::Program("armcmc-plant").string(),
                {"--duration", "2", "--lcm-url", bus.url(), "--report", "r.json", "--log", "r.lcm", "--csv", "r.csv"},
                folder.path().string());
  estimator.RunWhile(&plant);
  ASSERT_EQ(plant.Wait(), 0) << plant.Err();
  const nlohmann::json report = ReadJson(folder / "r.json");
  EXPECT_EQ(report["schema"], 1);
  EXPECT_EQ(report["packs"]["sent"], 20);
  EXPECT_EQ(report["packs"]["answered"], static_cast<int>(estimator.seqs.size()));
  // The stranger's message follows the answer: the one after the last answer may meet a plant that has stopped.
  EXPECT_GE(report["estimates"]["foreign"], static_cast<int>(estimator.seqs.size()) - 1);
  EXPECT_LE(report["estimates"]["foreign"], static_cast<int>(estimator.seqs.size()));
  EXPECT_EQ(report["mae_active_contact"]["K"], 0.0);
  EXPECT_EQ(report["coverage95"]["p"], 1.0);
  EXPECT_EQ(report["estimator"]["misses"]["own"], 2);
  EXPECT_EQ(report["estimator"]["degraded"].size(), 1u);
  EXPECT_THAT(plant.Out(), HasSubstr("20 of 20 sent"));
  EXPECT_EQ(estimator.run_ids.size(), 1u);

  lcm::LogFile log((folder / "r.lcm").string(), "r");
  int packs = 0;
  while (const lcm::LogEvent* event = log.readNextEvent()) packs += event->channel == "PLANT_PACK" ? 1 : 0;
  EXPECT_EQ(packs, 20);
  std::ifstream csv(folder / "r.csv");
  int lines = 0;
  for (std::string line; std::getline(csv, line);) ++lines;
  EXPECT_EQ(lines, 2'002);
}

TEST(LivePlant, NoticesOnceThatTheEstimatorWentSilentAndOnceThatItCameBack) {
  ARMCMC_REQUIRE_MULTICAST();
  const test::TestBus bus;
  const test::ScratchDir folder;
  StandIn estimator(bus.url(), [](std::int64_t seq) { return seq <= 5 || seq > 14; });
  Process plant(test::Program("armcmc-plant").string(),
                {"--duration", "2", "--lcm-url", bus.url(), "--report", "r.json"}, folder.path().string());
  estimator.RunWhile(&plant);
  ASSERT_EQ(plant.Wait(), 0) << plant.Err();
  EXPECT_THAT(plant.Err(), HasSubstr("silent"));
  EXPECT_THAT(plant.Err(), HasSubstr("answers again, at pack"));
  EXPECT_GE(ReadJson(folder / "r.json")["estimator_silences"]["noticed"], 1);
}

TEST(LivePlant, SaysThatNobodyAnsweredAndGoesOn) {
  ARMCMC_REQUIRE_MULTICAST();
  const test::TestBus bus;
  const test::ScratchDir folder;
  Process plant(test::Program("armcmc-plant").string(),
                {"--duration", "0.3", "--lcm-url", bus.url(), "--report", "r.json"}, folder.path().string());
  ASSERT_EQ(plant.Wait(), 0) << plant.Err();
  EXPECT_THAT(plant.Out(), HasSubstr("No estimator answered"));
  EXPECT_TRUE(ReadJson(folder / "r.json")["mae_active_contact"]["K"].is_null());
  EXPECT_THAT(plant.Err(), Not(HasSubstr("silent")));
}

TEST(LivePlant, StopsCleanlyOnASignalWithItsTableAndReport) {
  ARMCMC_REQUIRE_MULTICAST();
  for (const int signal : {SIGINT, SIGTERM}) {
    const test::TestBus bus;
    const test::ScratchDir folder;
    Process plant(test::Program("armcmc-plant").string(),
                  {"--duration", "1000", "--lcm-url", bus.url(), "--report", "r.json"}, folder.path().string());
    while (plant.Running() && plant.Out().find("packs of") == std::string::npos) usleep(10'000);
    plant.Signal(signal);
    EXPECT_EQ(plant.Wait(), 0) << plant.Err();
    EXPECT_THAT(plant.Out(), HasSubstr("Stopped early"));
    EXPECT_EQ(ReadJson(folder / "r.json")["interrupted"], true);
  }
}

}  // namespace
}  // namespace armcmc::plant_sim
