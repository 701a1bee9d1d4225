#pragma once

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <string>
#include <vector>

#include "integration/bus_recorder.hpp"
#include "integration/files.hpp"
#include "support/json.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test {

/// A plant and an estimator as two processes on a bus of their own, recorded.
class LivePair : public ::testing::Test {
 protected:
  void SetUp() override {
    ARMCMC_REQUIRE_MULTICAST();
    bus_ = std::make_unique<TestBus>();
    recorder_ = std::make_unique<BusRecorder>(bus_->url(), Log(), prefix_);
  }

  [[nodiscard]] std::string Log() const { return dir_ / "run.lcm"; }
  [[nodiscard]] std::string Report() const { return dir_ / "estimator.json"; }

  /// The estimator's configuration as it is shipped.
  [[nodiscard]] static std::string ShippedConfig() { return Text(SourceDir() / "rt/config/hunt_crossley.toml"); }
  /// Starts the estimator with this one instead.
  void UseConfig(const std::string& text) {
    config_ = dir_ / "estimator.toml";
    std::ofstream(config_) << text;
  }

  std::unique_ptr<Process> StartEstimator(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"--config", config_, "--lcm-url", bus_->url(), "--report", Report()};
    if (!prefix_.empty()) arguments.insert(arguments.end(), {"--prefix", prefix_});
    arguments.insert(arguments.end(), more.begin(), more.end());
    auto process = std::make_unique<Process>(Program("armcmc-estimator"), arguments);
    // It publishes its health from the start, also while no plant is there.
    EXPECT_TRUE(recorder_->WaitUntil([this, before = recorder_->statuses().size()] {
      return recorder_->statuses().size() > before;
    })) << process->err();
    return process;
  }

  std::unique_ptr<Process> StartPlant(const std::string& seconds, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = PlantArguments(seconds, more);
    arguments.insert(arguments.end(), {"--lcm-url", bus_->url()});
    return std::make_unique<Process>(Program("armcmc-plant"), arguments);
  }

  /// Sends what a plant sends in so many seconds, every pack as soon as the one before was answered: each has its whole
  /// deadline, and none waits for the clock. For what a run with many packs shows, whatever their pace. Once a test:
  /// all such runs have the same number.
  /// @return packs that were sent and answered.
  std::size_t Play(const std::string& seconds, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = PlantArguments(seconds, more);
    arguments.insert(arguments.end(), {"--csv", dir_ / "played.csv", "--log", dir_ / "played.lcm"});
    const Outcome made = RunProgram(Program("armcmc-plant"), arguments);
    EXPECT_EQ(made.code, 0) << made.err;
    return PlayLog(dir_ / "played.lcm");
  }

  /// The same of packs that are in a log.
  std::size_t PlayLog(const std::filesystem::path& log) {
    lcm::LogFile messages(log.string(), "r");
    lcm::LCM bus(bus_->url());
    if (!messages.good() || !bus.good()) {
      ADD_FAILURE() << "nothing to play, or no bus";
      return 0;
    }
    const std::size_t before = recorder_->estimates().size();
    std::size_t packs = 0;
    while (const lcm::LogEvent* event = messages.readNextEvent()) {
      if (event->channel.rfind(prefix_ + "PLANT_PACK", 0) == 0) {  // with or without the number of a version
        if (!recorder_->WaitForEstimates(before + packs)) break;
        ++packs;
      }
      EXPECT_EQ(bus.publish(event->channel, event->data, static_cast<unsigned>(event->datalen)), 0);
    }
    EXPECT_TRUE(recorder_->WaitForEstimates(before + packs)) << "no answer to pack " << packs;
    return packs;
  }

  /// Stops the estimator as Ctrl-C does and reads its report.
  Json Finish(Process* estimator) {
    estimator->Signal(SIGINT);
    const Process::Exit exit = estimator->Wait(std::chrono::seconds(10));
    EXPECT_EQ(exit.code, 0) << estimator->err();
    recorder_->Stop();
    return ReadJson(Report());
  }

  std::string config_ = SourceDir() / "rt/config/hunt_crossley.toml";
  ScratchDir dir_;
  std::filesystem::path scenario_ = SourceDir() / "plant_sim/scenarios/hunt_crossley_paper.toml";
  std::string seed_ = "7";  ///< Of the plant.
  std::string prefix_;      ///< Of all channels. Set before SetUp().
  std::unique_ptr<TestBus> bus_;
  std::unique_ptr<BusRecorder> recorder_;

 private:
  [[nodiscard]] std::vector<std::string> PlantArguments(const std::string& seconds,
                                                        const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"--scenario", scenario_.string(), "--seed", seed_, "--duration", seconds};
    if (!prefix_.empty()) arguments.insert(arguments.end(), {"--prefix", prefix_});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

}  // namespace armcmc::test
