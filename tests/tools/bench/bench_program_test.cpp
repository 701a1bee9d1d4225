// armcmc-bench as a user runs it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::bench::bench_program_test {
namespace {

using testing::HasSubstr;

class BenchProgram : public ::testing::Test {
 protected:
  test::Outcome Run(const std::vector<std::string>& arguments) const {
    return test::RunProgram(test::Program("armcmc-bench"), arguments, std::chrono::minutes(1), dir_.path());
  }
  test::ScratchDir dir_;
};

TEST_F(BenchProgram, TimesTheStepOfAPlantInTheJsonOfGoogleBenchmark) {
  const test::Outcome run = Run({"--model", "servo_axis", "--benchmark_filter=AdjustStep", "--benchmark_format=json",
                                 "--benchmark_min_time=0.01"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto report = nlohmann::json::parse(run.out);
  ASSERT_EQ(report.at("benchmarks").size(), 1U);
  const auto& step = report.at("benchmarks").at(0);
  EXPECT_THAT(step.at("name").get<std::string>(), HasSubstr("BM_AdjustStep/servo_axis/14979/100"));
  EXPECT_EQ(step.at("draws").get<double>(), 14979.0);
  EXPECT_GT(step.at("kish_ess").get<double>(), 1000.0);
  EXPECT_GT(step.at("real_time").get<double>(), 0.0);
  EXPECT_FALSE(step.contains("error_occurred"));
  EXPECT_TRUE(report.at("context").contains("instruction_set"));
}

TEST_F(BenchProgram, TimesTheLikelihoodByTheKernelAndByTheTape) {
  const test::Outcome run = Run({"--benchmark_filter=BM_Score/(hunt_crossley|soft_actuator)(:tape)?$",
                                 "--benchmark_format=json", "--benchmark_min_time=0.01"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto report = nlohmann::json::parse(run.out);
  std::vector<std::string> names;
  for (const auto& score : report.at("benchmarks")) {
    names.push_back(score.at("name"));
    EXPECT_GT(score.at("cpu_time").get<double>(), 0.0) << names.back();
    EXPECT_FALSE(score.contains("error_occurred")) << names.back();
  }
  EXPECT_THAT(names, testing::ElementsAre("BM_Score/hunt_crossley", "BM_Score/hunt_crossley:tape",
                                          "BM_Score/soft_actuator", "BM_Score/soft_actuator:tape"));
}

TEST_F(BenchProgram, RunsOnTheInstructionSetThatIsAskedFor) {
  const test::Outcome run =
      Run({"--instruction-set", "sse2", "--model", "hunt_crossley", "--benchmark_filter=NaiveLoop",
           "--benchmark_format=json", "--benchmark_min_time=0.01"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out).at("context").at("instruction_set"), "sse2");
}

TEST_F(BenchProgram, RefusesWhatIsNoPlantNoSetAndNoOption) {
  const test::Outcome plant = Run({"--model", "no_such_plant"});
  EXPECT_EQ(plant.code, 2);
  EXPECT_THAT(plant.err, HasSubstr("no_such_plant"));
  const test::Outcome set = Run({"--instruction-set", "mmx"});
  EXPECT_EQ(set.code, 2);
  EXPECT_THAT(set.err, HasSubstr("avx512, avx2, sse2"));
  const test::Outcome option = Run({"--benchmark_filter=none", "--fast"});
  EXPECT_EQ(option.code, 2);
  EXPECT_THAT(option.err, HasSubstr("--fast"));
}

TEST_F(BenchProgram, CountsTheDrawsThatItsDrawsAreWorth) {
  const test::Outcome run =
      Run({"--model", "hunt_crossley", "--benchmark_filter=EffectiveDraws/(cold|change)", "--benchmark_format=json"});
  ASSERT_EQ(run.code, 0) << run.err;
  for (const auto& what : nlohmann::json::parse(run.out).at("benchmarks")) {
    // The chain of 14 979 draws throws half away; a data-driven proposal loses little more.
    EXPECT_GT(what.at("chain").get<double>(), 2500.0) << what;
    EXPECT_LT(what.at("chain").get<double>(), 14979.0) << what;
    EXPECT_GT(what.at("weighted").get<double>(), what.at("chain").get<double>()) << what;
    // The chains of 200 replicates know a mean to 1 / sqrt(200 * 2500) = 1.4e-3 posterior standard deviations.
    EXPECT_LT(what.at("bias").get<double>(), 6e-3) << what;
  }
}

}  // namespace
}  // namespace armcmc::bench::bench_program_test
