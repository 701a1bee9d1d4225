// How the time of a step grows: the laws that it is measured with, and the script that fits it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/bench/law_family.hpp"
#include "armcmc/estimator.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::bench::scaling_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr std::array kTruth{4.0, 2.3, 1.7, 0.2, 1.4, 5e-3};  // K, B, p, c, q, m

TEST(LawFamily, HasLawsOfTwoToSixParametersThatExplainTheirPacks) {
  for (int d = kFewestLawParameters; d <= kMostLawParameters; ++d) {
    const EstimatorSettings settings = LawSettings(d);
    EXPECT_EQ(settings.num_parameters, d);
    Estimator estimator(settings);
    const auto result = estimator.MakeResult();
    Estimate estimate;
    for (const DataPack& pack : LawPacks(d, settings, 6, 100)) {
      EXPECT_EQ(estimator.Adjust(pack, std::numeric_limits<Nanos>::max(), ClockRef(), result.get()), Status::kOk);
      estimator.Execute(*result, &estimate);
      EXPECT_EQ(estimate.modes[0].num_samples, 100);
    }
    for (int i = 0; i < d; ++i) {
      const auto j = static_cast<std::size_t>(i);
      const MarginalSummary& m = estimate.modes[0].marginal[j];
      EXPECT_NEAR(m.ar_ap, kTruth[j], 5.0 * m.sd) << d << ' ' << settings.parameters[j].name;
    }
    // The rms of 100 residuals of the noise, whose standard deviation is 5 mN: five standard errors.
    EXPECT_NEAR(estimate.y_rmse, 5e-3, 5.0 * 5e-3 / std::sqrt(200.0)) << d;
  }
  EXPECT_THROW((void)LawSettings(1), std::out_of_range);
  EXPECT_THROW((void)LawText(7), std::out_of_range);
}

TEST(LawFamily, IsTimedOneByOne) {
  const test::Outcome run =
      test::RunProgram(test::Program("armcmc-bench"),
                       {"--model", "hunt_crossley", "--no-quality", "--benchmark_filter=Dimension/",
                        "--benchmark_format=json", "--benchmark_min_time=0.01"},
                       std::chrono::minutes(1));
  ASSERT_EQ(run.code, 0) << run.err;
  const auto runs = json::parse(run.out).at("benchmarks");
  ASSERT_EQ(runs.size(), 5U);
  for (const auto& one : runs) {
    EXPECT_FALSE(one.contains("error_occurred")) << one;
    EXPECT_EQ(one.at("draws").get<double>(), 14979.0) << one;
  }
}

class Scaling : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists("/usr/bin/python3")) GTEST_SKIP() << "no /usr/bin/python3";
  }

  /// Three repetitions, of which the median counts.
  void Add(const std::string& name, double ms) {
    for (const double factor : {1.0, 0.9, 7.0})
      runs_.push_back({{"name", name + "/manual_time"},
                       {"run_type", "iteration"},
                       {"real_time", 1e3 * ms * factor},
                       {"time_unit", "us"},
                       {"bytes", 3.0 * 1024 * 1024}});
    runs_.push_back({{"name", name + "_mean"}, {"run_type", "aggregate"}, {"real_time", 1e9}, {"time_unit", "us"}});
  }

  void AddAll() {
    for (const int k : {500, 2000, 5000, 14979, 50000})
      Add("BM_AdjustStep/axis/" + std::to_string(k) + "/100", 0.1 + 8e-5 * k);
    // Of another plant: not part of it.
    Add("BM_AdjustStep/other/5000/100", 99.0);
    for (const int n : {20, 50, 200, 256})
      Add("BM_AdjustStep/axis/14979/" + std::to_string(n), (0.1 + 8e-5 * 14979) * std::pow(n / 100.0, 0.4));
    for (const int d : {2, 3, 4, 5, 6}) Add("BM_Dimension/" + std::to_string(d), 0.3 * std::pow(d, 1.25));
    Add("BM_Memory/axis", 1.0);
  }

  test::Outcome Run(const std::vector<std::string>& more = {}) {
    std::ofstream(dir_ / "bench.json") << json{{"context", {{"instruction_set", "avx2"}}}, {"benchmarks", runs_}};
    std::vector<std::string> arguments{test::SourceDir() / "tools/bench/scaling", dir_ / "bench.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::RunProgram("/usr/bin/python3", arguments, std::chrono::minutes(1));
  }

  test::ScratchDir dir_;
  json runs_ = json::array();
};

TEST_F(Scaling, FindsTheExponentAndTheLineThatTimesWereMadeWith) {
  AddAll();
  const test::Outcome run = Run({"--json", dir_ / "fit.json", "--svg", dir_ / "plot.svg"});
  ASSERT_EQ(run.code, 0) << run.err;
  std::ifstream file(dir_ / "fit.json");
  const json fit = json::parse(file).at("fit");
  const json& samples = fit.at("samples");  // a power of 0.4 over all sizes
  EXPECT_NEAR(samples.at("exponent").get<double>(), 0.4, 1e-9);
  EXPECT_NEAR(samples.at("exponent_se").get<double>(), 0.0, 1e-6);
  EXPECT_EQ(samples.at("from"), 50);  // a tenth of 256 and more
  EXPECT_EQ(samples.at("sizes"), 4);
  EXPECT_NEAR(samples.at("largest_residual").get<double>(), 0.10700862, 1e-7);
  const json& draws = fit.at("draws");  // a line
  EXPECT_NEAR(draws.at("fixed_ms").get<double>(), 0.1, 1e-9);
  EXPECT_NEAR(draws.at("ms_each").get<double>(), 8e-5, 1e-12);
  EXPECT_NEAR(draws.at("largest_residual").get<double>(), 0.0, 1e-9);
  // Of 5000, 14979 and 50000: times 0.5, 1.29832 and 4.1 ms. Both this and the residual by numpy.polyfit.
  EXPECT_NEAR(draws.at("exponent").get<double>(), 0.91447202, 1e-7);
  EXPECT_GT(draws.at("exponent_se").get<double>(), 0.01);
  EXPECT_NEAR(fit.at("parameters").at("exponent").get<double>(), 1.25, 1e-9);
  EXPECT_FALSE(fit.at("parameters").contains("fixed_ms"));
  EXPECT_THAT(run.out, HasSubstr("`axis` with avx2"));
  EXPECT_THAT(run.out, HasSubstr("| samples | 0.40 ± 0.00 | from 50, 4 sizes |"));
  EXPECT_THAT(run.out, HasSubstr("`axis` with one result slot, default capacities: 3.00 MiB (limit 16 MiB)"));
  std::ifstream plot(dir_ / "plot.svg");
  const std::string svg{std::istreambuf_iterator<char>(plot), {}};
  EXPECT_THAT(svg, testing::StartsWith("<svg"));
  std::size_t dots = 0;
  for (std::size_t at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) ++dots;
  EXPECT_EQ(dots, 15U);
}

TEST_F(Scaling, RefusesAReportWithoutItsBenchmarks) {
  Add("BM_Draw/axis/5000/100", 1.0);
  const test::Outcome run = Run();
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("fewer than two sizes of draws"));
  EXPECT_EQ(test::RunProgram("/usr/bin/python3", {test::SourceDir() / "tools/bench/scaling"}).code, 2);
  const test::Outcome help =
      test::RunProgram("/usr/bin/python3", {test::SourceDir() / "tools/bench/scaling", "--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.out, HasSubstr("standard error"));
}

}  // namespace
}  // namespace armcmc::bench::scaling_test
