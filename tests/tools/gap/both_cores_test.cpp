// What both cores find together is what one finds alone, to the bit.

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/support/parallel.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::both_cores_test {
namespace {

TEST(BothCores, FindWhatOneFinds) {
  const auto equation = std::move(MakeEquations("hunt_crossley").front());
  const Recording recording =
      test::Measure({test::Hidden("coulomb_friction"), test::Hidden("force_drift")}, 4000, 0.05, 41).recording;
  const Diagnosis both = Diagnose(*equation, recording);
  Diagnosis alone;
  // Work inside of work is done by one thread.
  support::InParallel(2, [&](std::size_t i) {
    if (i == 0) alone = Diagnose(*equation, recording);
  });
  EXPECT_EQ(both.finding.verdict, alone.finding.verdict);
  EXPECT_EQ(both.finding.gap, alone.finding.gap);
  EXPECT_EQ(both.finding.p_missing, alone.finding.p_missing);
  ASSERT_EQ(both.finding.tried.size(), alone.finding.tried.size());
  for (std::size_t i = 0; i < both.finding.tried.size(); ++i) {
    const Candidate &mine = *both.finding.tried[i], &other = *alone.finding.tried[i];
    EXPECT_EQ(mine.names(), other.names());
    EXPECT_EQ(mine.fit.theta, other.fit.theta) << mine.names().front();
    EXPECT_EQ(mine.fit.heldout, other.fit.heldout) << mine.names().front();
    EXPECT_EQ(mine.probability, other.probability) << mine.names().front();
  }
}

}  // namespace
}  // namespace armcmc::gap::both_cores_test
