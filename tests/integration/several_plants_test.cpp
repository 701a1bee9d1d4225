// One estimator process for several plants, each of which is a process of its own.

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "integration/live_pair.hpp"

namespace armcmc::test::several_plants_test {
namespace {

class SeveralPlants : public LivePair {
 protected:
  SeveralPlants() { prefix_ = "C_"; }  // what is recorded
};

TEST_F(SeveralPlants, EachIsLearntByItself) {
  struct Plant {
    std::string model, scenario, prefix;
  };
  const std::vector<Plant> plants{{"hunt_crossley", "hunt_crossley_paper", "A_"},
                                  {"soft_actuator", "soft_actuator_paper", "B_"},
                                  {"hunt_crossley", "hunt_crossley_step", "C_"}};
  std::vector<std::string> arguments{"--lcm-url", bus_->url()};
  for (const Plant& plant : plants)
    arguments.insert(arguments.end(), {"--model", plant.model, "--prefix", plant.prefix, "--report",
                                       dir_ / (plant.prefix + "report.json")});
  Process estimator(Program("armcmc-estimator"), arguments);
  ASSERT_TRUE(recorder_->WaitUntil([this] { return !recorder_->statuses().empty(); })) << estimator.err();
  std::vector<std::unique_ptr<Process>> processes;
  for (const Plant& plant : plants)
    processes.push_back(std::make_unique<Process>(
        Program("armcmc-plant"), std::vector<std::string>{"--scenario", plant.scenario, "--duration", "4", "--prefix",
                                                          plant.prefix, "--lcm-url", bus_->url()}));
  for (auto& process : processes) EXPECT_EQ(process->Wait(std::chrono::seconds(30)).code, 0) << process->err();
  estimator.Signal(SIGINT);
  ASSERT_EQ(estimator.Wait(std::chrono::seconds(10)).code, 0) << estimator.err();
  for (const Plant& plant : plants) {
    const Json report = Json::Parse(Text(dir_ / (plant.prefix + "report.json")));
    EXPECT_EQ(report["plants_in_process"], 3);
    EXPECT_EQ(report["bus"]["prefix"], plant.prefix);
    EXPECT_GE(report["steps"], 30) << plant.prefix;
    EXPECT_EQ(report["misses"]["own"], 0) << plant.prefix;
    EXPECT_EQ(report["packs"]["lost"], 0) << plant.prefix;
  }
  const auto known = [&](const std::string& prefix) {
    return Json::Parse(Text(dir_ / (prefix + "report.json")))["parameters"];
  };
  EXPECT_NEAR(known("A_")[0]["parameters"]["K"]["ar_ap"].number(), 4.0, 0.2);
  EXPECT_NE(estimator.out().find("---- B_ ----"), std::string::npos) << estimator.out();
}

}  // namespace
}  // namespace armcmc::test::several_plants_test
