#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::two_hosts_test {
namespace {

using namespace std::chrono_literals;

/// Runs a command of the shell. @return what went wrong, in words; empty: nothing.
std::string Complaint(const std::string& command) {
  const Outcome o = RunProgram("/bin/sh", {"-c", command});
  return o.code == 0 ? "" : "`" + command + "` ended with " + std::to_string(o.code) + ": " + o.err;
}

/// Two computers on one cable: two network namespaces and a pair of virtual interfaces. Not everybody who may make a
/// namespace may use it: in a container or a chroot the link cannot be moved there, or nothing can be run inside. All
/// of it is tried first, and the tests are skipped where any of it is refused.
class TwoHosts : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<std::string> steps = {"ip netns add " + plant_host_, "ip netns add " + estimator_host_,
                                      "ip link add " + plant_device_ + " type veth peer name " + estimator_device_};
    for (const auto& [host, device, address] : {std::tuple{plant_host_, plant_device_, "10.77.0.1/24"},
                                                std::tuple{estimator_host_, estimator_device_, "10.77.0.2/24"}}) {
      const std::string in = "ip -n " + host + " ";
      steps.insert(steps.end(),
                   {"ip link set " + device + " netns " + host, in + "addr add " + address + " dev " + device,
                    in + "link set " + device + " up", in + "link set lo up",
                    in + "route add 224.0.0.0/4 dev " + device, "ip netns exec " + host + " /bin/sh -c 'exit 0'"});
    }
    for (const std::string& step : steps)
      if (const std::string complaint = Complaint(step); !complaint.empty())
        GTEST_SKIP() << "two hosts cannot be set up here: " << complaint;
  }
  void TearDown() override {
    // A device goes with its namespace. One that was never moved is still here, and takes its peer with it.
    for (const std::string& host : {plant_host_, estimator_host_}) Complaint("ip netns del " + host);
    Complaint("ip link del " + plant_device_);
  }

  static std::unique_ptr<Process> On(const std::string& host, const std::string& program,
                                     const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {"ip", "netns", "exec", host, Program(program).string()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return std::make_unique<Process>("/usr/bin/env", all);
  }
  std::unique_ptr<Process> Estimator(const std::string& prefix, const std::string& url = kUrl) {
    auto process = On(estimator_host_, "armcmc-estimator",
                      {"--config", (SourceDir() / "rt/config/hunt_crossley.toml").string(), "--lcm-url", url,
                       "--prefix", prefix, "--report", dir_ / (prefix + ".json")});
    EXPECT_TRUE(process->WaitForErr("waiting for the plant", 20s)) << process->err();
    return process;
  }
  std::unique_ptr<Process> Plant(const std::string& prefix, const std::string& seconds, const std::string& url = kUrl) {
    return On(plant_host_, "armcmc-plant",
              {"--scenario", (SourceDir() / "plant_sim/scenarios/hunt_crossley_paper.toml").string(), "--duration",
               seconds, "--lcm-url", url, "--prefix", prefix, "--report", dir_ / (prefix + "plant.json")});
  }
  Json Finish(Process* estimator, const std::string& prefix) {
    estimator->Signal(SIGINT);
    EXPECT_EQ(estimator->Wait(10s).code, 0) << estimator->err();
    return Read(prefix + ".json");
  }
  Json Read(const std::string& name) { return ReadJson(dir_ / name); }

  static constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=1";  // nobody else is on this cable
  ScratchDir dir_;
  const std::string id_ = std::to_string(getpid());
  const std::string plant_host_ = "armcmc-p" + id_, estimator_host_ = "armcmc-e" + id_;
  const std::string plant_device_ = "ap" + id_, estimator_device_ = "ae" + id_;
};

TEST_F(TwoHosts, PlantsAndEstimatorsOfTwoPrefixesShareACable) {
  auto one = Estimator("ONE_"), two = Estimator("TWO_");
  auto plant_one = Plant("ONE_", "1.5"), plant_two = Plant("TWO_", "1.5");
  EXPECT_EQ(plant_one->Wait(30s).code, 0) << plant_one->err();
  EXPECT_EQ(plant_two->Wait(30s).code, 0) << plant_two->err();
  for (auto& [estimator, prefix] : {std::pair{one.get(), "ONE_"}, std::pair{two.get(), "TWO_"}}) {
    const Json report = Finish(estimator, prefix);
    EXPECT_EQ(report["packs"]["received"], 15) << prefix;
    EXPECT_EQ(report["packs"]["lost"], 0) << prefix;
    EXPECT_EQ(report["plant"]["restarts"], 0) << "the other plant is not heard";
    EXPECT_GT(report["bus"]["foreign"], 12) << "although it is on the same cable";
  }
}

TEST_F(TwoHosts, WithTtlZeroNothingLeavesTheHost) {
  auto estimator = Estimator("P_", "udpm://239.255.76.67:7667?ttl=0");
  auto plant = Plant("P_", "0.5", "udpm://239.255.76.67:7667?ttl=0");
  EXPECT_EQ(plant->Wait(30s).code, 0) << plant->err();
  EXPECT_EQ(Finish(estimator.get(), "P_")["packs"]["received"], 0);
}

TEST_F(TwoHosts, LossAndDelayOfTheCableAreCountedAndSurvived) {
  // Frames that hold a whole pack: what the cable loses is a pack, and not a seventh of one.
  const std::string in_plant = "ip -n " + plant_host_ + " ", in_estimator = "ip -n " + estimator_host_ + " ";
  for (const std::string& step :
       {in_plant + "link set " + plant_device_ + " mtu 16000",
        in_estimator + "link set " + estimator_device_ + " mtu 16000",
        "ip netns exec " + plant_host_ + " tc qdisc add dev " + plant_device_ + " root netem loss 30% delay 5ms 2ms"})
    if (const std::string complaint = Complaint(step); !complaint.empty())
      GTEST_SKIP() << "no bad cable can be had here: " << complaint;
  auto estimator = Estimator("P_");
  auto plant = Plant("P_", "2");
  EXPECT_EQ(plant->Wait(30s).code, 0) << plant->err();
  const Json report = Finish(estimator.get(), "P_");
  const int received = report["packs"]["received"], lost = report["packs"]["lost"];
  EXPECT_GT(received, 5);
  EXPECT_GT(lost, 0) << "0.7^20 = 0.08 % that none is lost";
  EXPECT_LE(received + lost, 20);
  EXPECT_TRUE(report["parameters"][0]["known"]);
}

}  // namespace
}  // namespace armcmc::test::two_hosts_test
