#pragma once

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "integration/bus_recorder.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test {

/// A plant and an estimator as two processes on a bus of their own, recorded.
class LivePair : public ::testing::Test {
 protected:
  void SetUp() override {
    ARMCMC_REQUIRE_MULTICAST();
    bus_ = std::make_unique<TestBus>();
    recorder_ = std::make_unique<BusRecorder>(bus_->url(), Log());
  }

  [[nodiscard]] std::string Log() const { return dir_ / "run.lcm"; }
  [[nodiscard]] std::string Report() const { return dir_ / "estimator.json"; }

  std::unique_ptr<Process> StartEstimator(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"--config", config_, "--lcm-url", bus_->url(), "--report", Report()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    auto process = std::make_unique<Process>(Program("armcmc-estimator"), arguments);
    // It publishes its health from the start, also while no plant is there.
    EXPECT_TRUE(recorder_->WaitUntil([this, before = recorder_->statuses().size()] {
      return recorder_->statuses().size() > before;
    })) << process->err();
    return process;
  }

  std::unique_ptr<Process> StartPlant(const std::string& seconds, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"--scenario", scenario_.string(), "--seed",   "7", "--duration",
                                          seconds,      "--lcm-url",        bus_->url()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<Process>(Program("armcmc-plant"), arguments);
  }

  /// Stops the estimator as Ctrl-C does and reads its report.
  nlohmann::json Finish(Process* estimator) {
    estimator->Signal(SIGINT);
    const Process::Exit exit = estimator->Wait(std::chrono::seconds(10));
    EXPECT_EQ(exit.code, 0) << estimator->err();
    recorder_->Stop();
    std::ifstream file(Report());
    return nlohmann::json::parse(file);
  }

  std::string config_ = SourceDir() / "rt/config/hunt_crossley.toml";
  ScratchDir dir_;
  std::filesystem::path scenario_ = SourceDir() / "plant_sim/scenarios/hunt_crossley_paper.toml";
  std::unique_ptr<TestBus> bus_;
  std::unique_ptr<BusRecorder> recorder_;
};

}  // namespace armcmc::test
