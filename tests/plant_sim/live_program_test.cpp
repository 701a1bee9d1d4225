// armcmc-plant as a process on a bus of its own, with a stand-in estimator in this process.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/data_pack_t.hpp"
#include "armcmc/estimate_t.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::plant_sim::live_program_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

/// Starts armcmc-plant on a bus, in a folder into which it writes its report.
test::Process StartPlant(const test::ScratchDir& folder, const test::TestBus& bus, std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), {"--lcm-url", bus.url(), "--report", "r.json"});
  return {test::Program("armcmc-plant"), arguments, folder.path()};
}

/// Answers packs with the paper's true parameters, while `answers` says so.
class StandIn {
 public:
  StandIn(const std::string& url, std::function<bool(std::int64_t)> answers) : bus_(url), answers_(std::move(answers)) {
    bus_.subscribeFunction("PLANT_PACK", &StandIn::OnPack, this);
  }

  void RunWhile(test::Process* process) {
    while (process->running()) bus_.handleTimeout(20);
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

TEST(LivePlant, ScoresAPerfectEstimatorAsPerfect) {
  ARMCMC_REQUIRE_MULTICAST();
  const test::TestBus bus;
  const test::ScratchDir folder;
  StandIn estimator(bus.url(), [](std::int64_t) { return true; });
  test::Process plant = StartPlant(folder, bus, {"--duration", "1", "--log", "r.lcm", "--csv", "r.csv"});
  estimator.RunWhile(&plant);
  ASSERT_EQ(plant.Wait(10s).code, 0) << plant.err();
  const test::Json report = test::ReadJson(folder / "r.json");
  EXPECT_EQ(report["schema"], 1);
  EXPECT_EQ(report["packs"]["sent"], 10);
  EXPECT_EQ(report["packs"]["answered"], static_cast<int>(estimator.seqs.size()));
  // The stranger's message follows the answer: the one after the last answer may meet a plant that has stopped.
  EXPECT_GE(report["estimates"]["foreign"], static_cast<int>(estimator.seqs.size()) - 1);
  EXPECT_LE(report["estimates"]["foreign"], static_cast<int>(estimator.seqs.size()));
  EXPECT_EQ(report["mae_active_contact"]["K"], 0.0);
  EXPECT_EQ(report["coverage95"]["p"], 1.0);
  EXPECT_EQ(report["estimator"]["misses"]["own"], 2);
  EXPECT_EQ(report["estimator"]["degraded"].size(), 1u);
  EXPECT_THAT(plant.out(), HasSubstr("10 of 10 sent"));
  EXPECT_EQ(estimator.run_ids.size(), 1u);

  lcm::LogFile log((folder / "r.lcm").string(), "r");
  int packs = 0;
  while (const lcm::LogEvent* event = log.readNextEvent()) packs += event->channel == "PLANT_PACK" ? 1 : 0;
  EXPECT_EQ(packs, 10);
  std::ifstream csv(folder / "r.csv");
  int lines = 0;
  for (std::string line; std::getline(csv, line);) ++lines;
  EXPECT_EQ(lines, 1'002);
}

TEST(LivePlant, NoticesOnceThatTheEstimatorWentSilentAndOnceThatItCameBack) {
  ARMCMC_REQUIRE_MULTICAST();
  const test::TestBus bus;
  const test::ScratchDir folder;
  StandIn estimator(bus.url(), [](std::int64_t seq) { return seq <= 3 || seq > 9; });
  test::Process plant = StartPlant(folder, bus, {"--duration", "1.4"});
  estimator.RunWhile(&plant);
  ASSERT_EQ(plant.Wait(10s).code, 0) << plant.err();
  EXPECT_THAT(plant.err(), HasSubstr("silent"));
  EXPECT_THAT(plant.err(), HasSubstr("answers again, at pack"));
  EXPECT_GE(test::ReadJson(folder / "r.json")["estimator_silences"]["noticed"], 1);
}

TEST(LivePlant, SaysThatNobodyAnsweredAndGoesOn) {
  ARMCMC_REQUIRE_MULTICAST();
  const test::TestBus bus;
  const test::ScratchDir folder;
  test::Process plant = StartPlant(folder, bus, {"--duration", "0.3"});
  ASSERT_EQ(plant.Wait(10s).code, 0) << plant.err();
  EXPECT_THAT(plant.out(), HasSubstr("No estimator answered"));
  EXPECT_TRUE(test::ReadJson(folder / "r.json")["mae_active_contact"]["K"].is_null());
  EXPECT_THAT(plant.err(), Not(HasSubstr("silent")));
}

TEST(LivePlant, StopsCleanlyOnASignalWithItsTableAndReport) {
  ARMCMC_REQUIRE_MULTICAST();
  for (const int signal : {SIGINT, SIGTERM}) {
    const test::TestBus bus;
    const test::ScratchDir folder;
    test::Process plant = StartPlant(folder, bus, {"--duration", "1000"});
    while (plant.running() && plant.out().find("packs of") == std::string::npos) usleep(10'000);
    plant.Signal(signal);
    EXPECT_EQ(plant.Wait(10s).code, 0) << plant.err();
    EXPECT_THAT(plant.out(), HasSubstr("Stopped early"));
    EXPECT_EQ(test::ReadJson(folder / "r.json")["interrupted"], true);
  }
}

}  // namespace
}  // namespace armcmc::plant_sim::live_program_test
