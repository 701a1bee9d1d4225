#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "armcmc/support/estimator_config.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/file_text.hpp"

namespace armcmc::test {

/// Calibrations from runs of the simulated plant, whose noise is known.
class CalibrationRig : public ::testing::Test {
 protected:
  CalibrationRig() {
    std::ofstream(dir_ / "start.toml") << "schema = 1\n[model]\nname = \"hunt_crossley\"\n[noise]\nstd = 0.05\n"
                                          "[sampler]\ndraws = 300\n[gap_watch]\nenabled = false\n";
  }
  /// A recording of the paper's contact with that noise.
  std::string Record(const std::string& noise, int seed, const std::string& seconds) {
    std::ofstream(dir_ / "scenario.toml")
        << "schema = 1\nplant = \"hunt_crossley\"\nduration_s = 20.0\nsample_interval_s = 0.001\npack_period_s = 0.1\n"
           "[parameters]\nK = 4.0\nB = 2.3\np = 1.7\n[motion]\nmaster_offset = 0.6\nmaster_amplitude = [1.0]\n"
           "master_omega = [1.0]\n[noise.f]\n"
        << noise << "\n";
    return Plant(dir_ / "scenario.toml", seed, seconds);
  }
  std::string Plant(const std::string& scenario, int seed, const std::string& seconds) {
    std::string csv = dir_ / ("run" + std::to_string(seed) + ".csv");
    const Outcome o = RunProgram(Program("armcmc-plant"), {"--scenario", scenario, "--seed", std::to_string(seed),
                                                           "--duration", seconds, "--csv", csv});
    EXPECT_EQ(o.code, 0) << o.err;
    return csv;
  }
  Outcome Calibrate(const std::string& csv, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"--config", dir_ / "start.toml", "--data", csv, "--calibrate", dir_ / "found.toml"});
    return RunProgram(Program("armcmc-replay"), more, std::chrono::seconds(200));
  }
  EstimatorSettings Found() {
    auto root = support::StrictTable::FromFile(dir_ / "found.toml");
    return support::ReadEstimatorSettings(root, "");
  }
  struct Decisions {
    int informative = 0;
    std::vector<int> modifications;  ///< Pack numbers, the first pack left out.
  };
  Decisions Replay(const std::string& csv) {
    const Outcome o = RunProgram(Program("armcmc-replay"),
                                 {"--config", dir_ / "found.toml", "--data", csv, "--out", dir_ / "out.csv"});
    EXPECT_EQ(o.code, 0) << o.err;
    Decisions decisions;
    std::istringstream rows(TextOf(dir_ / "out.csv"));
    for (std::string row; std::getline(rows, row);) {
      if (row.find("hold,") != std::string::npos || row.starts_with("pack")) continue;
      ++decisions.informative;
      if (row.find("modification") != std::string::npos && decisions.informative > 1)
        decisions.modifications.push_back(std::stoi(row));
    }
    return decisions;
  }
  ScratchDir dir_;
};

}  // namespace armcmc::test
