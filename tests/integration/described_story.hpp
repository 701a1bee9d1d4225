#pragma once

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "integration/live_pair.hpp"

namespace armcmc::test {

/// The running estimator of a servo axis, and what armcmc-gap makes of the data that it keeps.
class DescribedStory : public LivePair {
 protected:
  void SetUp() override {
    LivePair::SetUp();
    config_ = dir_ / "estimator.toml";
    std::ofstream(config_) << "schema = 1\n";
  }

  /// The estimator with the axis as it comes along, on packs of a log. @return the report on the gap.
  Json Watched(const std::filesystem::path& log, std::size_t packs) {
    auto estimator = StartEstimator({"--model", "servo_axis", "--gap-log", dir_ / "logs"});
    EXPECT_EQ(PlayLog(log), packs) << estimator->err();
    estimator->Signal(SIGINT);
    EXPECT_EQ(estimator->Wait(std::chrono::seconds(10)).code, 0) << estimator->err();
    const std::string words = estimator->out();
    EXPECT_NE(words.find("armcmc-gap --model servo_axis --data "), std::string::npos) << words;
    const Json report = ReadJson(Report());
    for (const char* stage : {"collect", "adjust", "execute"}) EXPECT_EQ(report["allocations"][stage], 0) << stage;
    said_ = estimator->err();
    return report["gap"];
  }

  /// @return the result of armcmc-gap on what the estimator kept.
  Json Diagnosed(const Json& gap) {
    const Outcome named = RunProgram(Program("armcmc-gap"), {"--model", "servo_axis", "--data",
                                                             gap["window"].get<std::string>(), "--out", dir_ / "gap"});
    EXPECT_EQ(named.code, 0) << named.err;
    return ReadJson(dir_ / "gap/result.json");
  }

  std::string said_;  ///< By the estimator.
};

}  // namespace armcmc::test
