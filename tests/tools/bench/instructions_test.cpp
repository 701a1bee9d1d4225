// What a step costs, in instructions: the same on every machine and under any load.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <sstream>
#include <string>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::bench::instructions_test {
namespace {

constexpr double kTolerance = 0.03;
constexpr int kSteps = 2;

/// What the counts stand for; under valgrind a CPU has no AVX-512.
constexpr const char* kInstructionSet = "avx2";

std::filesystem::path CountsFile() { return test::SourceDir() / "tests/tools/bench/instructions.txt"; }

/// Lines "CASE COUNT", # for a comment.
std::map<std::string, double> CommittedCounts() {
  std::map<std::string, double> counts;
  std::ifstream file(CountsFile());
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string name;
    double count = 0.0;
    words >> name >> count;
    counts[name] = count;
  }
  return counts;
}

bool HasValgrind() { return std::filesystem::exists("/usr/bin/valgrind"); }

struct Counted {
  double instructions = 0.0;
  std::string set;
};

Counted Count(const std::string& name, int steps) {
  const test::Outcome run = test::RunProgram("/usr/bin/valgrind",
                                             {"--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null",
                                              test::Program("count_steps").string(), name, std::to_string(steps)},
                                             std::chrono::minutes(10), std::filesystem::temp_directory_path());
  Counted counted;
  std::smatch match;
  if (run.code == 0 && std::regex_search(run.err, match, std::regex("I +refs: +([0-9,]+)"))) {
    const std::string digits = std::regex_replace(match[1].str(), std::regex(","), "");
    counted.instructions = std::stod(digits);
  } else {
    ADD_FAILURE() << name << ": " << run.err;
  }
  if (std::regex_search(run.err, match, std::regex("instruction set (\\w+)"))) counted.set = match[1];
  return counted;
}

class Instructions : public ::testing::TestWithParam<const char*> {};

TEST_P(Instructions, OfAStepAreThoseThatWereCommitted) {
#if !defined(__GNUC__) || defined(__clang__) || __GNUC__ != 12
  GTEST_SKIP() << "the counts are those of g++ 12";
#endif
#if !defined(NDEBUG)
  GTEST_SKIP() << "the counts are those of a release build";
#endif
  if (!HasValgrind()) GTEST_SKIP() << "no /usr/bin/valgrind (tools/install-dependencies)";
  const std::string name = GetParam();
  const Counted before = Count(name, 1), after = Count(name, 1 + kSteps);
  if (HasFailure()) return;
  if (after.set != kInstructionSet) GTEST_SKIP() << "this CPU runs " << after.set << " under valgrind";
  const double steps = (after.instructions - before.instructions) / kSteps;
  const std::map<std::string, double> committed = CommittedCounts();
  const auto it = committed.find(name);
  ASSERT_NE(it, committed.end()) << "add to " << CountsFile() << ": " << name << ' '
                                 << static_cast<std::int64_t>(steps);
  EXPECT_NEAR(steps / it->second, 1.0, kTolerance)
      << name << ": " << static_cast<std::int64_t>(steps) << " instructions a step. If that is meant, write it to "
      << CountsFile() << " and say in the commit why";
}

INSTANTIATE_TEST_SUITE_P(Cases, Instructions,
                         ::testing::Values("press", "press_every_sample", "press_mixture", "press_effects",
                                           "press_tape", "waves_servo_axis", "waves_oscillator"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace armcmc::bench::instructions_test
