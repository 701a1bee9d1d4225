// The paper's soft actuator experiment on the authors' recording: gains of both valves and the predicted angle.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/support/csv.hpp"
#include "plants/soft_actuator/model.hpp"
#include "support/packs.hpp"
#include "support/paths.hpp"

namespace armcmc::paper_actuator_test {
namespace {

TEST(PaperActuator, FindsBothGainsAndPredictsTheAngle) {
  ARMCMC_REQUIRE_DATA("paper/soft_actuator.csv");
  support::CsvRequest request;
  request.columns = {"t", "u_c", "u_d", "p", "pdot", "alpha"};
  const auto samples = support::ReadCsv(*test::FindData("paper/soft_actuator.csv"), request);
  Estimator estimator(BuiltinSettings("soft_actuator"));
  const auto result = estimator.MakeResult();
  Estimate e;
  constexpr int kPackSamples = 100;
  // theta1 + theta2 p_atm of the authors' model.
  constexpr std::array<double, 2> kGain{4.0611e-4, -2.9012e-4};
  std::array<int, 2> updates{};
  double restarted = 0.0;
  double free_run = 0.0;
  const int packs = static_cast<int>(samples.num_rows() - 1) / kPackSamples;
  for (int k = 1; k <= packs; ++k) {
    DataPack pack = test::BlankPack(SoftActuator::kInfo.plant, k, kPackSamples);
    for (std::size_t n = 0; n < kPackSamples; ++n) {
      const std::size_t row = static_cast<std::size_t>(kPackSamples * (k - 1)) + 1 + n;
      for (std::size_t c = 0; c < 4; ++c) pack.u[n][c] = samples.columns[1 + c][row];
      pack.y[n] = samples.columns[5][row];
    }
    estimator.Adjust(pack, 0, {}, result.get());
    estimator.Execute(*result, &e);
    for (std::size_t n = 0; n < kPackSamples; ++n) {
      restarted += std::pow(e.y_shown[n] - pack.y[n], 2);
      free_run += std::pow(e.y_shown_free_run[n] - pack.y[n], 2);
    }
    for (std::size_t m = 0; m < 2; ++m) {
      if (!e.modes[m].updated || ++updates[m] <= 2) continue;
      EXPECT_NEAR(e.modes[m].marginal[0].ar_map / kGain[m], 1.0, 0.01) << "pack " << k << " mode " << m;
      // theta2 cannot be seen here: pressure moves by 3 Pa. Its posterior must say so.
      EXPECT_GT(e.modes[m].marginal[1].sd, 0.5e-8);
    }
  }
  EXPECT_GT(updates[0], 100);
  EXPECT_GT(updates[1], 80);
  // Root of the sum of squares over 20 000 samples, in rad; the authors' stored results: 32.5 (RLS) and 61.5.
  EXPECT_LT(std::sqrt(restarted), 0.1);
  EXPECT_LT(std::sqrt(free_run), 0.2);
}

}  // namespace
}  // namespace armcmc::paper_actuator_test
