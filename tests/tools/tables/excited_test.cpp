// The excited actuator, where all four parameters can be identified: every valve's ARMCMC against the best variants of
// the baselines, over noise seeds that nothing was tuned on.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "armcmc/tables/coverage.hpp"
#include "armcmc/tables/method.hpp"
#include "armcmc/tables/recording.hpp"
#include "armcmc/tables/score.hpp"
#include "armcmc/tables/trace.hpp"
#include "plants/soft_actuator/model.hpp"
#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::tables::excited_test {
namespace {

constexpr int kSeeds = 10;
constexpr std::uint64_t kFirstSeed = 3001;

std::filesystem::path Simulated(std::uint64_t seed, const std::filesystem::path& folder) {
  std::filesystem::path csv = folder / (std::to_string(seed) + ".csv");
  const test::Outcome outcome =
      test::RunProgram(test::Program("armcmc-plant"),
                       {"--scenario", "soft_actuator_excited", "--seed", std::to_string(seed), "--csv", csv.string()});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return csv;
}

/// Share of the packs of one run that cover, for one valve, level and parameter, and its variance if they are right.
struct Share {
  double covered = 0.0, variance = 0.0;
};

Share CoverageOf(const Recording& r, const Trace& trace, std::size_t mode, std::size_t level, std::size_t parameter) {
  Share share;
  std::vector<double> sd;
  for (std::size_t k = 0; k < trace.packs.size(); ++k) {
    const ModeTrace& known = trace.packs[k].modes[mode];
    const std::size_t last = (k + 1) * static_cast<std::size_t>(trace.pack_samples);
    if (!known.updated || !known.known || last >= r.size() || r.u[mode][last - 1] == 0.0) continue;
    const auto& [from, to] = known.interval[level][parameter];
    const double truth = r.truth[parameter][last - 1];
    share.covered += from <= truth && truth <= to ? 1.0 : 0.0;
    sd.push_back(known.sd[parameter]);
  }
  share.covered /= static_cast<double>(sd.size());
  share.variance = NullCoverageVariance(sd, level);
  return share;
}

// One test, since it is one set of runs.
TEST(ExcitedActuator, ArmcmcIsAheadOnEveryParameterAndItsIntervalsHold) {
  const test::ScratchDir folder;
  const EstimatorSettings settings = ScenarioSettings("soft_actuator_excited");
  std::vector<MethodSpec> methods = PaperMethods(settings);
  std::erase_if(methods,
                [](const MethodSpec& m) { return m.key == "rls" || m.key == "pf" || m.key == "rls_no_forgetting"; });
  std::map<std::string, std::array<double, 5>> mean;  // g of u_c and u_d, theta1, theta2, angle
  std::array<std::array<std::array<double, 2>, 3>, 2> covered{}, variance{};
  int modifications = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const auto csv = Simulated(kFirstSeed + static_cast<std::uint64_t>(seed), folder.path());
    const Recording recording = ReadRecording(csv, SoftActuator::kInfo.plant, ConstantOf(settings, "p_atm"));
    for (const MethodSpec& spec : methods) {
      const Trace trace = RunMethod(recording, spec);
      const ActuatorScore s = ScoreActuator(recording, trace, Point::kMap, spec.settings);
      const std::array<double, 5> one{s.g_rel_error[0], s.g_rel_error[1], s.theta1_l2, s.theta2_l2, s.alpha_l2};
      for (std::size_t i = 0; i < one.size(); ++i) mean[spec.key][i] += one[i] / kSeeds;
      if (spec.key != "armcmc") continue;
      modifications += static_cast<int>(std::count_if(trace.packs.begin() + 10, trace.packs.end(), [](const auto& p) {
        return p.decision == static_cast<int>(Decision::kModification);
      }));
      for (std::size_t m = 0; m < 2; ++m)
        for (std::size_t l = 0; l < kLevels.size(); ++l)
          for (std::size_t d = 0; d < 2; ++d) {
            const Share share = CoverageOf(recording, trace, m, l, d);
            covered[m][l][d] += share.covered / kSeeds;
            variance[m][l][d] += share.variance / (kSeeds * kSeeds);
          }
    }
  }
  const char* const rows[] = {"g of u_c", "g of u_d", "theta1", "theta2"};
  for (const auto& [key, theirs] : mean) {
    if (key == "armcmc") continue;
    // Least squares that never forget are the same estimate but for the noise in their regressor, and follow no change.
    const double share = key == "rls_per_mode_keeps_all" ? 1.02 : 1.0;
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(mean.at("armcmc")[i], share * theirs[i]) << key << ", " << rows[i];
  }
  EXPECT_LT(mean.at("armcmc")[4], mean.at("pf_per_mode")[4]);
  EXPECT_NEAR(mean.at("armcmc")[4] / mean.at("rls_per_mode_keeps_all")[4], 1.0, 1e-3);
  EXPECT_EQ(modifications, 0);
  for (std::size_t m = 0; m < 2; ++m)
    for (std::size_t l = 0; l < kLevels.size(); ++l)
      for (std::size_t d = 0; d < 2; ++d)
        EXPECT_NEAR(covered[m][l][d], kLevels[l], 3.0 * std::sqrt(variance[m][l][d]))
            << "valve " << m << ", parameter " << d;
}

}  // namespace
}  // namespace armcmc::tables::excited_test
