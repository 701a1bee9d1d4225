#include "armcmc/summary.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "core/estimator_rig.hpp"
#include "plants/hunt_crossley/model.hpp"

namespace armcmc::summary_test {
namespace {

// What has changed for sure, perhaps, and not at all: each draw moves by its own probability.
TEST(Summary, MovesEachDrawByItsProbabilityOfAChange) {
  constexpr int kDraws = 43;  // not a whole number of vectors
  const EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  const ParameterSpace space(settings, settings.noise[0]);
  AdjustResult result(1, 3, kDraws);
  ModeDraws& draws = result.modes[0];
  draws.draws = kDraws;
  draws.moves = draws.some_changed = true;
  std::mt19937_64 g(3);
  std::normal_distribution<double> normal;
  for (int k = 0; k < kDraws; ++k) {
    for (std::size_t d = 0; d < 3; ++d) draws.u[d][k] = 0.1 * normal(g);
    draws.weight[k] = 1.0 / kDraws;
    draws.visits[k] = 1;
    draws.chain[k] = k;
    draws.changed[k] = 0.5 * (k % 3);
  }
  std::array<double, 3> expected{};
  for (std::size_t d = 0; d < 3; ++d) {
    draws.end[d] = EndOfPack(0.0, 0.2, 1.5, -10.0, 10.0);
    draws.end_of_changed[d] = EndOfPack(0.0, -0.3, 1.1, -10.0, 10.0);
    for (int k = 0; k < kDraws; ++k) {
      const double v = draws.u[d][k], c = draws.changed[k];
      const double u = (1.0 - c) * (0.2 + 1.5 * v) + c * (-0.3 + 1.1 * v);
      EXPECT_NEAR(draws.AtEnd(static_cast<int>(d), k), u, 1e-12);
      expected[d] += space.Theta(static_cast<int>(d), u) / kDraws;
    }
  }
  SummaryWorkspace workspace(kDraws);
  ModeEstimate estimate;
  Summarise(HuntCrossley::kInfo, settings.constants, space, draws, &workspace, &estimate);
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(estimate.marginal[d].ar_ap, expected[d], 1e-9 * space.scale[d]) << d;
}

}  // namespace
}  // namespace armcmc::summary_test
