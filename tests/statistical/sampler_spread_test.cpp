// What the draws of all packs before leave in a posterior: its spread over sampler seeds, on the same data.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/estimator_rig.hpp"

namespace armcmc::sampler_spread_test {
namespace {

constexpr int kPacks = 120;
constexpr int kLearnt = 40;  // packs after which the posterior is near a normal law
constexpr int kSeeds = 6;

struct Pack {
  std::array<std::array<double, 3>, kSeeds> mean{}, sd{};
  bool known = true;
};

std::array<Pack, kPacks + 1> PosteriorsOfSeeds(int draws) {
  std::array<Pack, kPacks + 1> packs;
  for (std::size_t seed = 0; seed < kSeeds; ++seed) {
    EstimatorSettings settings = BuiltinSettings("hunt_crossley");
    settings.sampler.rule = DrawRule::kFixed;
    settings.sampler.fixed_draws = draws;
    settings.sampler.seed = 100 + seed;
    test::Rig rig(settings);
    test::Normal normal(7);  // the same noise for all
    for (int k = 1; k <= kPacks; ++k) {
      const DataPack data = test::FillContactPack(k, &test::Contact::At, [&](double, const test::Place& at) {
        return test::ContactTruth{4.0, 2.3, 1.7}.Force(at.x, at.v) + 0.1 * normal();
      });
      const ModeEstimate& e = rig.Step(data).modes[0];
      Pack& pack = packs[static_cast<std::size_t>(k)];
      pack.known = pack.known && e.known;
      for (std::size_t d = 0; d < 3; ++d) {
        pack.mean[seed][d] = e.marginal[d].ar_ap;
        pack.sd[seed][d] = e.marginal[d].sd;
      }
    }
  }
  return packs;
}

// If every posterior carried its sampling error on, the spread of the means would be .05 to .06 posterior standard
// deviations, and without control variates of second order .07 to .09; here it is below .02. That of the standard
// deviations, which are of the chain of one pack, is 3 %.
TEST(SamplerSpread, OfARecursionIsSmallBesideThePosterior) {
  const auto packs = PosteriorsOfSeeds(5000);
  std::array<double, 3> of_mean{}, of_sd{};
  int counted = 0;
  for (std::size_t k = kLearnt; k <= kPacks; ++k) {
    const Pack& pack = packs[k];
    if (!pack.known) continue;
    ++counted;
    for (std::size_t d = 0; d < 3; ++d) {
      double mean = 0.0, sd = 0.0;
      for (std::size_t s = 0; s < kSeeds; ++s) {
        mean += pack.mean[s][d] / kSeeds;
        sd += pack.sd[s][d] / kSeeds;
      }
      for (std::size_t s = 0; s < kSeeds; ++s) {
        of_mean[d] += std::pow((pack.mean[s][d] - mean) / sd, 2) / (kSeeds - 1);
        of_sd[d] += std::pow(pack.sd[s][d] / sd - 1.0, 2) / (kSeeds - 1);
      }
    }
  }
  ASSERT_GT(counted, 60);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_LT(std::sqrt(of_mean[d] / counted), 0.02) << d;
    EXPECT_LT(std::sqrt(of_sd[d] / counted), 0.04) << d;
  }
}

}  // namespace
}  // namespace armcmc::sampler_spread_test
