#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test {
namespace {

using namespace std::chrono_literals;

int Ip(const std::string& command) { return RunProgram("/bin/sh", {"-c", command}).code; }

/// Two computers on one cable: two network namespaces and a pair of virtual interfaces.
class TwoHosts : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string id = std::to_string(getpid());
    plant_host_ = "armcmc-p" + id;
    estimator_host_ = "armcmc-e" + id;
    if (Ip("ip netns add " + plant_host_) != 0) GTEST_SKIP() << "network namespaces need iproute2 and CAP_NET_ADMIN";
    ASSERT_EQ(Ip("ip netns add " + estimator_host_), 0);
    const std::string p = "ap" + id, e = "ae" + id;
    if (Ip("ip link add " + p + " type veth peer name " + e) != 0) GTEST_SKIP() << "this kernel has no veth";
    for (const auto& [host, device, address] : {std::tuple{plant_host_, p, std::string("10.77.0.1/24")},
                                                std::tuple{estimator_host_, e, std::string("10.77.0.2/24")}}) {
      const std::string in = "ip -n " + host + " ";
      ASSERT_EQ(Ip("ip link set " + device + " netns " + host + " && " + in + "addr add " + address + " dev " + device +
                   " && " + in + "link set " + device + " up && " + in + "link set lo up && " + in +
                   "route add 224.0.0.0/4 dev " + device),
                0);
    }
    plant_device_ = p;
  }
  void TearDown() override { Ip("ip netns del " + plant_host_ + "; ip netns del " + estimator_host_); }

  static std::unique_ptr<Process> On(const std::string& host, const std::string& program,
                                     const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {"netns", "exec", host, Program(program).string()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return std::make_unique<Process>("/usr/sbin/ip", all);
  }
  std::unique_ptr<Process> Estimator(const std::string& prefix, const std::string& url = kUrl) {
    auto process = On(estimator_host_, "armcmc-estimator",
                      {"--config", (SourceDir() / "rt/config/hunt_crossley.toml").string(), "--lcm-url", url,
                       "--prefix", prefix, "--report", dir_ / (prefix + ".json")});
    EXPECT_TRUE(process->WaitForErr("waiting for the plant", 20s)) << process->err();
    return process;
  }
  std::unique_ptr<Process> Plant(const std::string& prefix, const std::string& url = kUrl) {
    return On(plant_host_, "armcmc-plant",
              {"--scenario", (SourceDir() / "plant_sim/scenarios/hunt_crossley_paper.toml").string(), "--duration", "3",
               "--lcm-url", url, "--prefix", prefix, "--report", dir_ / (prefix + "plant.json")});
  }
  nlohmann::json Finish(Process* estimator, const std::string& prefix) {
    estimator->Signal(SIGINT);
    EXPECT_EQ(estimator->Wait(10s).code, 0) << estimator->err();
    return Read(prefix + ".json");
  }
  nlohmann::json Read(const std::string& name) {
    std::ifstream file(dir_ / name);
    return nlohmann::json::parse(file);
  }

  static constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=1";  // nobody else is on this cable
  ScratchDir dir_;
  std::string plant_host_, estimator_host_, plant_device_;
};

TEST_F(TwoHosts, PlantsAndEstimatorsOfTwoPrefixesShareACable) {
  auto one = Estimator("ONE_"), two = Estimator("TWO_");
  auto plant_one = Plant("ONE_"), plant_two = Plant("TWO_");
  EXPECT_EQ(plant_one->Wait(30s).code, 0) << plant_one->err();
  EXPECT_EQ(plant_two->Wait(30s).code, 0) << plant_two->err();
  for (auto& [estimator, prefix] : {std::pair{one.get(), "ONE_"}, std::pair{two.get(), "TWO_"}}) {
    const nlohmann::json report = Finish(estimator, prefix);
    EXPECT_EQ(report["packs"]["received"], 30) << prefix;
    EXPECT_EQ(report["packs"]["lost"], 0) << prefix;
    EXPECT_EQ(report["plant"]["restarts"], 0) << "the other plant is not heard";
    EXPECT_GT(report["bus"]["foreign"], 25) << "although it is on the same cable";
  }
}

TEST_F(TwoHosts, WithTtlZeroNothingLeavesTheHost) {
  auto estimator = Estimator("P_", "udpm://239.255.76.67:7667?ttl=0");
  auto plant = Plant("P_", "udpm://239.255.76.67:7667?ttl=0");
  EXPECT_EQ(plant->Wait(30s).code, 0) << plant->err();
  EXPECT_EQ(Finish(estimator.get(), "P_")["packs"]["received"], 0);
}

TEST_F(TwoHosts, LossAndDelayOfTheCableAreCountedAndSurvived) {
  if (Ip("ip netns exec " + plant_host_ + " tc qdisc add dev " + plant_device_ +
         " root netem loss 20% delay 5ms 2ms") != 0) {
    GTEST_SKIP() << "this kernel has no netem";
  }
  auto estimator = Estimator("P_");
  auto plant = Plant("P_");
  EXPECT_EQ(plant->Wait(30s).code, 0) << plant->err();
  const nlohmann::json report = Finish(estimator.get(), "P_");
  const int received = report["packs"]["received"], lost = report["packs"]["lost"];
  EXPECT_GT(received, 10);
  EXPECT_GT(lost, 0) << "0.8^30 = 0.1 % that none is lost";
  EXPECT_LE(received + lost, 30);
  EXPECT_TRUE(report["parameters"][0]["known"]);
}

}  // namespace
}  // namespace armcmc::test
