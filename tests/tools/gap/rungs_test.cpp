// What the workflow names, told step by step.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/gap/workflow.hpp"
#include "rungs.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::rungs_test {
namespace {

using armcmc::test::HiddenEffect;

Result Told(const std::vector<HiddenEffect>& effects, double noise_sd, const std::vector<std::string>& without = {}) {
  WorkflowRequest request;
  request.model = "hunt_crossley";
  request.data = test::Measure(effects, 8000, noise_sd, 21).recording;
  request.diagnose.without = without;
  return RunWorkflow(request).result;
}

TEST(Rungs, OfNothingMissingAreNone) {
  const Result result = Told({}, 0.05);
  ASSERT_EQ(result.verdict, Verdict::kNone) << result.sentence;
  EXPECT_TRUE(result.ladder.empty());
  EXPECT_TRUE(result.complete);
  EXPECT_EQ(result.remainder.share, 0.0);
}

TEST(Rungs, OfOneEffectAreOne) {
  const Result result = Told({test::Hidden("coulomb_friction")}, 0.05);
  ASSERT_EQ(result.verdict, Verdict::kNamed) << result.sentence;
  ASSERT_EQ(result.ladder.size(), 1U);
  const LadderRung& rung = result.ladder.front();
  EXPECT_EQ(rung.effects, std::vector<std::string>{"coulomb_friction"});
  EXPECT_EQ(rung.heldout_error, result.gap.after.rmse);
  EXPECT_EQ(rung.closed_fraction, result.gap.closed_fraction);
  EXPECT_EQ(rung.probability, result.effects.front().probability);
  EXPECT_NEAR(rung.remainder_ratio, 1.0, 0.1);
  EXPECT_TRUE(result.complete);
}

TEST(Rungs, OfTwoEffectsTheOneThatExplainsMostIsFirst) {
  HiddenEffect friction = test::Hidden("coulomb_friction"), bias = test::Hidden("force_bias");
  bias.amplitude[0] *= 0.3;
  const Result result = Told({friction, bias}, 0.02);
  ASSERT_EQ(result.verdict, Verdict::kNamed) << result.sentence;
  ASSERT_EQ(result.effects.size(), 2U) << result.sentence;
  ASSERT_EQ(result.ladder.size(), 2U);
  EXPECT_EQ(result.ladder[0].effects, std::vector<std::string>{"coulomb_friction"});
  EXPECT_EQ(result.ladder[1].effects, std::vector<std::string>{"force_bias"});
  EXPECT_GT(result.gap.before.rmse, result.ladder[0].heldout_error);
  EXPECT_GT(result.ladder[0].heldout_error, result.ladder[1].heldout_error);
  EXPECT_LT(result.ladder[0].closed_fraction, result.ladder[1].closed_fraction);
  EXPECT_EQ(result.ladder[1].heldout_error, result.gap.after.rmse);
}

TEST(Rungs, OfATieAreWhatIsSureAndThenWhatIsOpen) {
  using Sets = std::vector<std::vector<std::string>>;
  HiddenEffect friction = test::Hidden("coulomb_friction"), bias = test::Hidden("force_bias");
  bias.amplitude[0] *= 0.3;
  constexpr Eigen::Index kDiagnosed = 2800;
  const Recording recording = test::Measure({friction, bias}, 4000, 0.02, 21).recording;
  const std::unique_ptr<Equation> equation = std::move(MakeEquations("hunt_crossley").front());
  Diagnosis diagnosis = Diagnose(*equation, recording.Slice(0, kDiagnosed), {});
  const HeldOut heldout(*equation, *diagnosis.wide, recording, kDiagnosed);
  // As if these hypotheses were equally good, the first the best.
  const auto rungs_of = [&](const Sets& sets) {
    Finding& finding = diagnosis.finding;
    finding.verdict = Verdict::kAmbiguous;
    finding.set.clear();
    for (const std::vector<std::string>& names : sets) {
      const auto with = std::find_if(finding.tried.begin(), finding.tried.end(),
                                     [&](const CandidatePtr& tried) { return tried->names() == names; });
      if (with != finding.tried.end()) finding.set.push_back(*with);
    }
    EXPECT_EQ(finding.set.size(), sets.size());
    finding.best = finding.set.front();
    Result result;
    WriteRungs(*equation, heldout, diagnosis, &result);
    Sets rungs;
    for (const LadderRung& rung : result.ladder) rungs.push_back(rung.effects);
    return rungs;
  };
  EXPECT_EQ(rungs_of({{"coulomb_friction"}, {"viscous_friction"}}), (Sets{{"coulomb_friction", "viscous_friction"}}));
  EXPECT_EQ(rungs_of({{"coulomb_friction", "force_bias"}, {"coulomb_friction", "force_drift"}}),
            (Sets{{"coulomb_friction"}, {"force_bias", "force_drift"}}));
  // Whether there is a bias besides is open: no rung tells of what the best hypothesis does not have.
  EXPECT_EQ(rungs_of({{"coulomb_friction"}, {"coulomb_friction", "force_bias"}}), (Sets{{"coulomb_friction"}}));
  EXPECT_EQ(rungs_of({{"coulomb_friction", "force_bias"}, {"viscous_friction"}}),
            (Sets{{"coulomb_friction + force_bias", "viscous_friction"}}));
}

TEST(Rungs, OfWhatHasNoNameAreNoneAndAllIsLeft) {
  const Result result = Told({test::Hidden("periodic_disturbance")}, 0.02, {"periodic_disturbance"});
  ASSERT_EQ(result.verdict, Verdict::kUnnamed) << result.sentence;
  EXPECT_TRUE(result.ladder.empty());
  EXPECT_FALSE(result.complete);
  EXPECT_EQ(result.remainder.share, 1.0);
  EXPECT_EQ(result.remainder.where.size(), result.where.size());
}

}  // namespace
}  // namespace armcmc::gap::rungs_test
