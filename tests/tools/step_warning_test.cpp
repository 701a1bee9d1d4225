// Plants whose states are too fast for the samples, as a user meets them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test::step_warning_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class StepWarning : public ::testing::Test {
 protected:
  Outcome Run(const char* program, const std::vector<std::string>& arguments) const {
    return RunProgram(Program(program), arguments, std::chrono::minutes(1), dir_.path());
  }
  /// x' = (u - x) / tau and what else there is; tau = 4 ms, sampled every 10 ms.
  void Write(const std::string& law, const std::string& substeps, const std::string& more_states) const {
    std::ofstream(dir_.path() / "fast.toml")
        << "schema = 1\nname = \"fast\"\noutput = \"y\"\nlaw = \"" << law
        << "\"\n[signals]\nu = { unit = \"V\", role = \"drive\" }\ny = { unit = \"V\" }\n[parameters]\n"
           "tau = { unit = \"s\", prior = \"lognormal\", mean = 0.005, sd = 1.0 }\n"
           "[states]\nx = { unit = \"V\", start = \"u\", rate = \"(u - x)/tau\", substeps = "
        << substeps << " }\n"
        << more_states << "[noise]\nstd = 0.02\nestimate = true\n";
    std::ofstream csv(dir_.path() / "fast.csv");
    csv << "t,u,y\n";
    const double decay = std::exp(-2.5), mean = (1.0 - decay) / 2.5;
    double x = 1.0, before = 1.0;
    for (int n = 0; n < 300; ++n) {
      const double u = n % 60 < 30 ? 1.0 : -1.0;
      if (n > 0) x = x * decay + before * (mean - decay) + u * (1.0 - mean);
      before = u;
      csv << 0.01 * n << ',' << u << ',' << x + 0.01 * std::sin(2.39996 * n * n) << '\n';
    }
  }
  ScratchDir dir_;
};

TEST_F(StepWarning, SaysHowManySubstepsAreEnoughUntilTheyAre) {
  Write("x", "1", "");
  const auto warning = AllOf(HasSubstr("WARNING: the states change too fast"), HasSubstr("substeps = "));
  const Outcome check = Run("armcmc-model", {"check", "fast.toml", "--data", "fast.csv"});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_THAT(check.out, warning);
  const Outcome replay = Run("armcmc-replay", {"--model", "fast.toml", "--data", "fast.csv", "--out", "e.csv"});
  EXPECT_EQ(replay.code, 0) << replay.err;
  EXPECT_THAT(replay.out, warning);
  Write("x", "4", "");
  EXPECT_THAT(Run("armcmc-model", {"check", "fast.toml", "--data", "fast.csv"}).out, Not(HasSubstr("WARNING")));
  EXPECT_THAT(Run("armcmc-replay", {"--model", "fast.toml", "--data", "fast.csv", "--out", "e.csv"}).out,
              Not(HasSubstr("WARNING")));
}

// What the estimator runs and whole recordings cannot is no reason to fail.
TEST_F(StepWarning, AStateThatAnotherReadsLateCanBeReplayed) {
  Write("z", "1", "z = { unit = \"V\", start = \"u\", rate = \"(delay(x, 0.01) - z)/tau\" }\n");
  const Outcome replay = Run("armcmc-replay", {"--model", "fast.toml", "--data", "fast.csv", "--out", "e.csv"});
  EXPECT_EQ(replay.code, 0) << replay.err;
  const Outcome check = Run("armcmc-model", {"check", "fast.toml", "--data", "fast.csv"});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("cannot be determined: the rate of a state remembers a state"));
}

}  // namespace
}  // namespace armcmc::test::step_warning_test
