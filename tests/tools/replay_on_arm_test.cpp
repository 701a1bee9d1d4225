// Whole recordings through the estimator on AArch64, under qemu: the same estimates as here. The kernels give the same
// bits on both (kernel_bits_test.cpp). The mathematical library rounds some functions in another way, and Eigen fuses
// multiplications and additions; the fits between packs amplify that to some 1e-7 posterior standard deviations.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "support/paths.hpp"
#include "support/process.hpp"
#include "tools/csv_rows.hpp"

namespace armcmc::test::replay_on_arm_test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

std::string TextOf(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

fs::path OnPath(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (fs::exists(fs::path(folder) / program)) return fs::path(folder) / program;
  return {};
}

/// Estimates of a recording, with few draws: qemu takes some hundred times as long.
class ReplayOnArm : public testing::Test {
 protected:
  void SetUp() override {
    if (emulator_.empty()) GTEST_SKIP() << "qemu-aarch64 is missing: tools/install-dependencies --with aarch64";
    if (!fs::exists(program_))
      GTEST_SKIP() << "not cross-built: cmake --preset aarch64 && cmake --build --preset aarch64";
    if (fs::last_write_time(program_) < fs::last_write_time(Program("armcmc-replay")))
      GTEST_SKIP() << program_ << " is older than this build: cmake --build --preset aarch64";
  }

  /// Runs both, and compares all cells: words are equal, numbers differ by at most 0.001 posterior standard deviations
  /// (those without one by 0.001 of their value), a twentieth of the Monte Carlo error of 1000 draws.
  void ExpectSameEstimates(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--out", dir_ / "here.csv"});
    const Outcome here = RunProgram(Program("armcmc-replay"), arguments);
    ASSERT_EQ(here.code, 0) << here.err;
    arguments.back() = dir_ / "arm.csv";
    arguments.insert(arguments.begin(), program_);
    const Outcome arm = RunProgram(emulator_, arguments, 200s);
    ASSERT_EQ(arm.code, 0) << arm.err;
    EXPECT_NE(arm.out.find(" on neon\n"), std::string::npos) << arm.out;
    const auto expected = RowsOf(TextOf(dir_ / "here.csv")), found = RowsOf(TextOf(dir_ / "arm.csv"));
    ASSERT_EQ(found.size(), expected.size());
    ASSERT_GT(expected.size(), 2U);
    for (std::size_t n = 0; n < expected.size(); ++n) {
      for (const auto& [name, text] : expected[n]) {
        SCOPED_TRACE("pack " + std::to_string(n + 1) + ", " + name);
        const std::string& other = found[n].at(name);
        if (text == other) continue;
        const auto sd = expected[n].find(name.substr(0, name.find('_')) + "_sd");
        const double size = sd != expected[n].end() ? std::stod(sd->second) : std::abs(std::stod(text));
        EXPECT_NEAR(std::stod(other), std::stod(text), 1e-3 * size);
      }
    }
  }

  const fs::path emulator_ = OnPath("qemu-aarch64");
  const fs::path program_ = SourceDir() / "build-aarch64/bin/armcmc-replay";
  const ScratchDir dir_;
};

TEST_F(ReplayOnArm, AContactGivesTheSameEstimates) {
  const Outcome plant = RunProgram(
      Program("armcmc-plant"), {"--scenario", "hunt_crossley_drift", "--duration", "1.5", "--csv", dir_ / "run.csv"});
  ASSERT_EQ(plant.code, 0) << plant.err;
  std::string config = TextOf(SourceDir() / "rt/config/hunt_crossley.toml");
  const std::string draws = "draws = \"chernoff\"";
  config.replace(config.find(draws), draws.size(), "draws = 1000");
  std::ofstream(dir_ / "config.toml") << config;
  ExpectSameEstimates({"--config", dir_ / "config.toml", "--data", dir_ / "run.csv"});
}

TEST_F(ReplayOnArm, APlantFileWithStatesGivesTheSameEstimates) {
  const Outcome plant =
      RunProgram(Program("armcmc-plant"), {"--model", "pendulum", "--duration", "0.3", "--csv", dir_ / "run.csv"});
  ASSERT_EQ(plant.code, 0) << plant.err;
  ExpectSameEstimates({"--model", SourceDir() / "core/plants/pendulum/plant.toml", "--data", dir_ / "run.csv"});
}

}  // namespace
}  // namespace armcmc::test::replay_on_arm_test
