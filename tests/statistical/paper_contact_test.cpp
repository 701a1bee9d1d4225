// The paper's Hunt-Crossley experiment on the authors' recording: point estimates, force, coverage.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/support/csv.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "support/packs.hpp"
#include "support/paths.hpp"

namespace armcmc::paper_contact_test {
namespace {

constexpr int kPackSamples = 100;
constexpr std::array<double, 3> kTruth{4.0, 2.3, 1.7};

struct Recording {
  std::vector<double> x, v, f, f_true;
};

Recording Load() {
  support::CsvRequest request;
  request.columns = {"t", "x", "v", "f", "f_true"};
  auto samples = support::ReadCsv(*test::FindData("paper/hunt_crossley.csv"), request);
  return {samples.columns[1], samples.columns[2], samples.columns[3], samples.columns[4]};
}

struct Score {
  std::array<double, 3> mae{};       ///< In contact while an estimate is shown.
  std::array<double, 3> coverage{};  ///< Of the 95 % intervals, over the packs with an estimate.
  double force_contact_mn = 0.0, force_overall_mn = 0.0;
  int modifications = 0;
};

/// Runs the recording; an estimate of the pack that ends at t is shown during [t + 0.1 s, t + 0.2 s), as in the paper.
Score Replay(const Recording& data, const std::vector<double>& force) {
  Estimator estimator(BuiltinSettings("hunt_crossley"));
  const auto result = estimator.MakeResult();
  Estimate e;
  Score score;
  const int packs = (static_cast<int>(data.x.size()) - 1) / kPackSamples;
  std::vector<ModeEstimate> estimates(static_cast<std::size_t>(packs) + 1);
  int known = 0;
  for (int k = 1; k <= packs; ++k) {
    DataPack pack = test::BlankPack(HuntCrossley::kInfo.plant, k, kPackSamples);
    for (int n = 0; n < kPackSamples; ++n) {
      const auto row = static_cast<std::size_t>(kPackSamples * (k - 1) + 1 + n);
      pack.y[static_cast<std::size_t>(n)] = force[row];
      pack.u[static_cast<std::size_t>(n)] = {data.x[row], data.v[row]};
    }
    estimator.Adjust(pack, 0, {}, result.get());
    estimator.Execute(*result, &e);
    const ModeEstimate& m = estimates[static_cast<std::size_t>(k)] = e.modes[0];
    score.modifications += m.updated && m.decision == Decision::kModification ? 1 : 0;
    if (!m.known) continue;
    ++known;
    for (std::size_t d = 0; d < 3; ++d)
      score.coverage[d] += m.marginal[d].q025 <= kTruth[d] && kTruth[d] <= m.marginal[d].q975 ? 1.0 : 0.0;
  }
  for (double& c : score.coverage) c /= known;
  int shown = 0;
  int contact = 0;
  for (std::size_t i = 0; i < data.x.size(); ++i) {
    const int k = static_cast<int>(i) / kPackSamples - 1;
    const ModeEstimate* m = k >= 1 ? &estimates[static_cast<std::size_t>(k)] : nullptr;
    const bool has = m != nullptr && m->known;
    const bool in_contact = data.x[i] >= 0.0;
    double predicted = 0.0;
    if (has && in_contact) {
      predicted =
          std::pow(data.x[i], m->marginal[2].ar_map) * (m->marginal[0].ar_map + m->marginal[1].ar_map * data.v[i]);
      for (std::size_t d = 0; d < 3; ++d) score.mae[d] += std::fabs(m->marginal[d].ar_map - kTruth[d]);
      ++shown;
    }
    const double error = 1e3 * std::fabs(predicted - data.f_true[i]);
    score.force_overall_mn += error;
    if (in_contact) {
      score.force_contact_mn += error;
      ++contact;
    }
  }
  for (double& e_d : score.mae) e_d /= shown;
  score.force_contact_mn /= contact;
  score.force_overall_mn /= static_cast<double>(data.x.size());
  return score;
}

TEST(PaperContact, TracksTheAuthorsRecording) {
  ARMCMC_REQUIRE_DATA("paper/hunt_crossley.csv");
  const Recording data = Load();
  const Score score = Replay(data, data.f);
  // Batch least squares on all data so far reaches 0.116, 0.103, 0.013 and 17.1, 12.6 mN.
  EXPECT_LT(score.mae[0], 0.07);
  EXPECT_LT(score.mae[1], 0.05);
  EXPECT_LT(score.mae[2], 0.006);
  EXPECT_LT(score.force_contact_mn, 8.0);
  EXPECT_LT(score.force_overall_mn, 6.0);
  EXPECT_EQ(score.modifications, 1);  // the first pack, and no false alarm after it
}

TEST(LongPaperContact, CoversTheTruthOverTwentyNoiseSeeds) {
  ARMCMC_REQUIRE_DATA("paper/hunt_crossley.csv");
  const Recording data = Load();
  constexpr int kSeeds = 20;
  Score mean;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    test::Normal normal(static_cast<std::uint64_t>(seed));
    std::vector<double> force = data.f_true;
    for (double& f : force) f += 0.1 * normal();
    const Score score = Replay(data, force);
    for (std::size_t d = 0; d < 3; ++d) {
      mean.coverage[d] += score.coverage[d] / kSeeds;
      mean.mae[d] += score.mae[d] / kSeeds;
    }
    mean.force_contact_mn += score.force_contact_mn / kSeeds;
    mean.force_overall_mn += score.force_overall_mn / kSeeds;
    EXPECT_EQ(score.modifications, 1) << "seed " << seed;
  }
  for (const double coverage : mean.coverage) EXPECT_GE(coverage, 0.90);
  EXPECT_LT(mean.mae[0], 0.075);
  EXPECT_LT(mean.mae[1], 0.055);
  EXPECT_LT(mean.mae[2], 0.006);
  EXPECT_LT(mean.force_contact_mn, 8.0);
  EXPECT_LT(mean.force_overall_mn, 6.0);
  RecordProperty("K_mae", std::to_string(mean.mae[0]));
  RecordProperty("coverage_K", std::to_string(mean.coverage[0]));
}

}  // namespace
}  // namespace armcmc::paper_contact_test
