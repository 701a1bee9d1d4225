#include "armcmc/tables/trace.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "armcmc/tables/method.hpp"
#include "plants/hunt_crossley/model.hpp"

namespace armcmc::tables::trace_test {
namespace {

/// 8 s of a contact whose K grows by 0.2 N/m^p per second.
Recording Drifting() {
  Recording r;
  r.plant = HuntCrossley::kInfo.plant;
  std::mt19937_64 g(3);
  std::normal_distribution<double> noise(0.0, 0.1);
  for (int n = 0; n < 8001; ++n) {
    const double t = n * r.dt;
    const double x = 1.0 + 0.5 * std::sin(8.2 * t), v = 4.1 * std::cos(8.2 * t), k = 4.0 + 0.2 * t;
    r.u[0].push_back(x);
    r.u[1].push_back(v);
    r.target.push_back(std::pow(x, 1.7) * (k + 2.3 * v));
    r.y.push_back(r.target.back() + noise(g));
    r.truth[0].push_back(k);
    r.truth[1].push_back(2.3);
    r.truth[2].push_back(1.7);
  }
  return r;
}

TEST(RunMethod, HasTheIntervalsThatThePosteriorPublishes) {
  MethodSpec spec;
  spec.key = "armcmc";
  spec.settings = BuiltinSettings("hunt_crossley");
  spec.pack_samples = 100;
  const Trace trace = RunMethod(Drifting(), spec);
  ASSERT_EQ(trace.packs.size(), 80U);
  ASSERT_GT(trace.packs.back().modes[0].p_drifted, 0.9) << "else the draws need not be moved";
  for (std::size_t k = 40; k < trace.packs.size(); ++k) {
    const PackTrace& pack = trace.packs[k];
    ASSERT_TRUE(pack.modes[0].updated);
    for (std::size_t d = 0; d < 3; ++d) {
      const MarginalSummary& m = pack.marginal[d];
      const auto& at50 = pack.modes[0].interval[0][d];
      const auto& at95 = pack.modes[0].interval[2][d];
      const double tolerance = 0.05 * m.sd;
      EXPECT_NEAR(at50[0], m.q25, tolerance) << "pack " << k << ", parameter " << d;
      EXPECT_NEAR(at50[1], m.q75, tolerance) << "pack " << k << ", parameter " << d;
      EXPECT_NEAR(at95[0], m.q025, tolerance) << "pack " << k << ", parameter " << d;
      EXPECT_NEAR(at95[1], m.q975, tolerance) << "pack " << k << ", parameter " << d;
    }
  }
}

}  // namespace
}  // namespace armcmc::tables::trace_test
