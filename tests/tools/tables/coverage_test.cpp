#include "armcmc/tables/coverage.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "armcmc/tables/experiment.hpp"
#include "armcmc/tables/report.hpp"
#include "plants/hunt_crossley/model.hpp"

namespace armcmc::tables::coverage_test {
namespace {

TEST(NullCoverageVariance, OfPacksThatTeachNothingIsThatOfOneDecision) {
  const std::vector<double> sd(50, 0.3);
  for (std::size_t l = 0; l < kLevels.size(); ++l)
    EXPECT_NEAR(NullCoverageVariance(sd, l), kLevels[l] * (1.0 - kLevels[l]), 1e-6);
}

TEST(NullCoverageVariance, OfPosteriorsThatHaveNothingInCommonFallsWithTheirNumber) {
  std::vector<double> sd(10);
  double s = 1.0;
  for (double& v : sd) v = s *= 1e-6;
  EXPECT_NEAR(NullCoverageVariance(sd, 0), 0.25 / 10, 1e-6);
}

TEST(NullCoverageVariance, IsWhatRunsOfAnExactEstimatorShow) {
  // A mean learnt from packs of growing size: the posterior is exact, so are its intervals.
  constexpr int kRuns = 200'000, kPacks = 30;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<double> sd;
  std::array<double, 3> square{};
  for (int run = 0; run < kRuns; ++run) {
    double information = 0.0, weighted = 0.0;
    std::array<double, 3> share{};
    sd.clear();
    for (int k = 1; k <= kPacks; ++k) {
      information += k, weighted += std::sqrt(k) * normal(random);
      sd.push_back(1.0 / std::sqrt(information));
      const double z = weighted / std::sqrt(information);
      for (std::size_t l = 0; l < share.size(); ++l) share[l] += std::fabs(z) < kHalfWidths[l] ? 1.0 / kPacks : 0.0;
    }
    for (std::size_t l = 0; l < share.size(); ++l) square[l] += std::pow(share[l] - kLevels[l], 2) / kRuns;
  }
  // Relative standard error of a variance from so many runs: 0.3 % for a normal law, some times that for shares near 1.
  for (std::size_t l = 0; l < square.size(); ++l)
    EXPECT_NEAR(NullCoverageVariance(sd, l), square[l], 0.03 * square[l]) << kLevels[l];
}

TEST(JudgeCoverage, SaysMoreThanTwoStandardErrors) {
  EXPECT_EQ(JudgeCoverage(0.61, 0, 0.06), Calibration::kAsStated);
  EXPECT_EQ(JudgeCoverage(0.63, 0, 0.06), Calibration::kTooWide);
  EXPECT_EQ(JudgeCoverage(0.37, 0, 0.06), Calibration::kTooNarrow);
  EXPECT_EQ(CoverageText(0.606, 0, 0.0597), "60.6 ± 6");
  EXPECT_EQ(CoverageText(0.862, 2, 0.027), "86.2 ± 2.7, too narrow");
}

TEST(NullCoverageVariance, PosteriorsWithoutWidthAreOneDecision) {
  const std::vector<double> sd(5, 0.0);
  for (std::size_t level = 0; level < kLevels.size(); ++level)
    EXPECT_NEAR(NullCoverageVariance(sd, level), kLevels[level] * (1.0 - kLevels[level]), 1e-3);
}

/// Four runs of one pack each, at rest with K = 4, that all cover K: the spread between the runs is zero.
Experiment RunsThatAllCover() {
  Recording r;
  r.plant = HuntCrossley::kInfo.plant;
  for (int i = 0; i <= 300; ++i) {
    const double t = 1e-3 * i, x = 0.8 + 0.6 * std::sin(12.0 * t), v = 7.2 * std::cos(12.0 * t);
    r.u[0].push_back(x);
    r.u[1].push_back(v);
    r.y.push_back(std::pow(x, 1.7) * (4.0 + 2.3 * v));
    r.truth[0].push_back(4.0);
    r.truth[1].push_back(2.3);
    r.truth[2].push_back(1.7);
  }
  r.target = r.y;
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = 1000;
  return RunExperiment("x", "x", 4, [&](int) { return r; }, {{"armcmc", "ARMCMC", settings}});
}

TEST(RunExperiment, TheErrorOfACoverageIsNotZeroBecauseAllRunsCover) {
  const Experiment e = RunsThatAllCover();
  const Row& row = e.Find("armcmc_map");
  ASSERT_EQ(row.contact.coverage[2][0], 1.0);  // data without noise: the truth is in the middle
  // Between the error of independent packs and that of one decision a run.
  EXPECT_LE(row.coverage_error[2][0], std::sqrt(0.95 * 0.05 / 4.0));
  EXPECT_GT(row.coverage_error[2][0], std::sqrt(0.95 * 0.05 / 12.0));
  Result result;
  result.likelihoods = {{"gaussian", "gaussian", 4, row}};
  const auto json = ToJson(result);
  const auto& entry = json.at("likelihoods").at("gaussian").at("gaussian");
  EXPECT_EQ(entry.at("coverage95_standard_error").at("K"), row.coverage_error[2][0]);
  EXPECT_EQ(entry.at("coverage95_verdict").at("K"), "as stated");
  EXPECT_EQ(entry.at("coverage50_verdict").at("K"),
            NameOf(JudgeCoverage(row.contact.coverage[0][0], 0, row.coverage_error[0][0])));
  const std::string cell = CoverageText(row.contact.coverage[0][0], 0, row.coverage_error[0][0]);
  EXPECT_NE(ToText(result).find(cell), std::string::npos);
  EXPECT_NE(ToHtml(result).find(cell), std::string::npos);
}

TEST(CoverageSentence, NamesWhatIsOff) {
  Row row;
  row.contact.coverage = {{{0.5, 0.5, 0.5}, {0.9, 0.9, 0.9}, {0.95, 0.8, 0.95}}};
  for (auto& level : row.coverage_error) level.fill(0.03);
  const std::string text = CoverageSentence(row);
  EXPECT_NE(text.find("95 % of B 80 ± 3, too narrow"), std::string::npos) << text;
  EXPECT_EQ(text.find(" of K"), std::string::npos) << text;
  row.contact.coverage[2][1] = 0.95;
  EXPECT_NE(CoverageSentence(row).find("as stated"), std::string::npos);
}

}  // namespace
}  // namespace armcmc::tables::coverage_test
