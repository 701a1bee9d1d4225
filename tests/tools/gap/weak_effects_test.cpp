// The probability that nothing is missing, where nothing is named.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap {
namespace {

using armcmc::test::HiddenEffect;
using test::Measure;

Diagnosis Judge(const std::vector<HiddenEffect>& effects, double noise_sd, unsigned seed) {
  static const auto equation = std::move(MakeEquations("hunt_crossley").front());
  return Diagnose(*equation, Measure(effects, 6000, noise_sd, seed).recording);
}

TEST(WeakEffects, NothingIsProbableWhereNothingIsHidden) {
  double sum = 0.0;
  for (const unsigned seed : {11U, 12U, 13U, 14U}) {
    const Finding finding = Judge({}, 0.1, seed).finding;
    EXPECT_EQ(finding.verdict, Verdict::kNone);
    sum += finding.p_none;
  }
  EXPECT_GT(sum / 4.0, 0.7);
  // An effect of a thirtieth of the noise could not have been seen.
  EXPECT_LT(sum / 4.0, 0.995);
}

TEST(WeakEffects, AnEffectTooWeakToBeNamedIsHeldProbable) {
  HiddenEffect bias = test::Hidden("force_bias");
  bias.amplitude[0] = 0.007;  // N, 0.07 of the noise: 5 standard deviations
  const Diagnosis diagnosis = Judge({bias}, 0.1, 21);
  const Finding& finding = diagnosis.finding;
  EXPECT_EQ(finding.verdict, Verdict::kNone);
  EXPECT_LT(finding.p_none, 0.1);
  double total = finding.p_none, of_bias = 0.0;
  for (const CandidatePtr& candidate : finding.tried) {
    total += candidate->probability;
    if (candidate->names() == std::vector<std::string>{"force_bias"}) of_bias += candidate->probability;
  }
  EXPECT_NEAR(total, 1.0, 1e-9);
  EXPECT_GT(of_bias, 0.5);
}

}  // namespace
}  // namespace armcmc::gap
