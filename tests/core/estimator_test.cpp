#include "armcmc/estimator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/estimator_rig.hpp"
#include "plants/soft_actuator/model.hpp"

namespace armcmc::estimator_test {
namespace {

using test::Contact;
using test::Rig;

TEST(Estimator, FirstPackIsAModificationFromTheInitialPrior) {
  Rig rig;
  const Estimate& e = rig.Step(Contact{}.Pack(10));
  EXPECT_EQ(rig.status, Status::kOk);
  EXPECT_TRUE(e.active);
  EXPECT_EQ(e.mode, 0);
  EXPECT_EQ(e.modes[0].decision, Decision::kModification);
  EXPECT_EQ(e.modes[0].lambda, 0.0);
  EXPECT_TRUE(std::isinf(e.modes[0].zeta));
  EXPECT_EQ(e.modes[0].draws, 14979) << "the relation is degenerate at lambda = 0: the full Chernoff number";
  EXPECT_EQ(e.modes[0].num_samples, 100);
  EXPECT_NEAR(e.modes[0].noise_std, 0.1, 1e-15) << "fixed";
  test::ExpectUsable(e.modes[0], rig.estimator.settings());
}

TEST(Estimator, LearnsTheTruthFromOneContact) {
  Rig rig;
  const Contact contact;
  for (std::int64_t seq = 1; seq <= 40; ++seq) {
    rig.Step(contact.Pack(seq));
    if (rig.estimate().modes[0].updated) test::ExpectUsable(rig.estimate().modes[0], rig.estimator.settings());
  }
  const double truth[] = {contact.k, contact.b, contact.p};
  for (std::size_t d = 0; d < 3; ++d) {
    const MarginalSummary& m = rig.estimate().modes[0].marginal[d];
    EXPECT_NEAR(m.ar_ap, truth[d], 4.0 * m.sd) << d;
    EXPECT_LT(m.sd, 0.1) << d << ": forty packs narrow a prior of sd 2";
    EXPECT_NEAR(m.chain_mean, m.ar_ap, 0.3 * m.sd) << d << ": the weights and the chain see the same posterior";
  }
  EXPECT_EQ(rig.estimate().modes[0].decision, Decision::kReinforcement);
  EXPECT_EQ(rig.estimate().modes[0].marginal[0].ar_map, rig.estimate().modes[0].marginal[0].ar_ap);
}

TEST(Estimator, AbruptChangeIsAModification) {
  Rig rig;
  for (std::int64_t seq = 5; seq <= 15; ++seq) rig.Step(Contact{}.Pack(seq));
  EXPECT_EQ(rig.estimate().modes[0].decision, Decision::kReinforcement);
  const Contact stiffer{.k = 7.0};
  rig.Step(stiffer.Pack(16));
  EXPECT_EQ(rig.estimate().modes[0].decision, Decision::kModification);
  EXPECT_EQ(rig.estimate().modes[0].lambda, 0.0);
  for (std::int64_t seq = 17; seq <= 30; ++seq) rig.Step(stiffer.Pack(seq));
  const MarginalSummary& m = rig.estimate().modes[0].marginal[0];
  EXPECT_NEAR(m.ar_ap, 7.0, 4.0 * m.sd);
}

TEST(Estimator, FreeMotionHoldsWhatIsKnownAndReportsItInactive) {
  Rig rig;
  rig.Step(Contact{}.Pack(10));
  const ModeEstimate before = rig.estimate().modes[0];
  const Estimate& e = rig.Step(Contact{}.Pack(test::kFreePack));
  EXPECT_EQ(rig.status, Status::kHeld);
  EXPECT_FALSE(e.active);
  EXPECT_EQ(e.mode, e.num_modes);
  EXPECT_EQ(e.report_mode, 0);
  EXPECT_TRUE(e.modes[0].known);
  EXPECT_FALSE(e.modes[0].updated);
  EXPECT_EQ(e.modes[0].decision, Decision::kHold);
  EXPECT_EQ(e.modes[0].num_samples, 0);
  EXPECT_EQ(e.y_pred, 0.0);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_EQ(e.modes[0].marginal[d].ar_map, before.marginal[d].ar_map);
    EXPECT_EQ(e.modes[0].marginal[d].ar_ap, before.marginal[d].ar_ap);
    EXPECT_EQ(e.modes[0].marginal[d].q50, before.marginal[d].q50);
    EXPECT_GE(e.modes[0].marginal[d].sd, before.marginal[d].sd) << "it may have drifted";
    EXPECT_LT(e.modes[0].marginal[d].sd, 1.1 * before.marginal[d].sd) << "which is improbable";
  }
}

TEST(Estimator, FreeMotionHoldsThePosteriorToTheBitWhereNothingDrifts) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.forgetting.drift_share = 0.0;
  Rig rig(settings);
  rig.Step(Contact{}.Pack(10));
  const ModeEstimate before = rig.estimate().modes[0];
  const Estimate& e = rig.Step(Contact{}.Pack(test::kFreePack));
  EXPECT_EQ(e.modes[0].decision, Decision::kHold);
  EXPECT_EQ(std::memcmp(&e.modes[0].marginal, &before.marginal, sizeof before.marginal), 0);
}

TEST(Estimator, FreeMotionBeforeAnyContactKnowsNothing) {
  Rig rig;
  const Estimate& e = rig.Step(Contact{}.Pack(test::kFreePack));
  EXPECT_EQ(rig.status, Status::kHeld);
  EXPECT_FALSE(e.modes[0].known);
  EXPECT_FALSE(e.active);
  rig.Step(Contact{}.Pack(70));
  EXPECT_EQ(rig.estimate().modes[0].decision, Decision::kModification) << "the first pack that says something";
}

TEST(Estimator, ContactThatReturnsStartsFromWhatTheLastOneLearnt) {
  Rig rig;
  const Contact contact;
  std::int64_t seq = 1;
  while (!rig.Step(contact.Pack(seq)).modes[0].updated) ++seq;
  ModeEstimate first = rig.estimate().modes[0];
  for (++seq; seq < test::kSecondContact; ++seq) rig.Step(contact.Pack(seq));
  EXPECT_FALSE(rig.estimate().active);
  const Estimate& again = rig.Step(contact.Pack(test::kSecondContact));
  EXPECT_EQ(again.modes[0].decision, Decision::kReinforcement);
  for (std::size_t d = 0; d < 3; ++d)
    EXPECT_LT(again.modes[0].marginal[d].sd, 0.1 * first.marginal[d].sd) << d << ": forty packs against one";
}

TEST(Estimator, TooFewContactSamplesHoldThePosteriorAndTheForceIsPredicted) {
  Rig rig;
  rig.Step(Contact{}.Pack(10));
  DataPack pack = Contact{}.Pack(11);
  for (std::size_t n = 0; n < 98; ++n) pack.u[n][0] = -0.1;
  const Estimate& e = rig.Step(pack);
  EXPECT_EQ(e.modes[0].num_samples, 2);
  EXPECT_EQ(rig.status, Status::kHeld);
  EXPECT_FALSE(e.modes[0].updated);
  ASSERT_TRUE(e.active);
  const double truth = std::pow(pack.u[99][0], 1.7) * (4.0 + 2.3 * pack.u[99][1]);
  EXPECT_NEAR(e.y_pred, truth, 0.5) << "the posterior of the pack before is known";
  // Three samples are enough.
  pack = Contact{}.Pack(12);
  for (std::size_t n = 0; n < 97; ++n) pack.u[n][0] = -0.1;
  rig.Step(pack);
  EXPECT_EQ(rig.status, Status::kOk);
  EXPECT_TRUE(rig.estimate().modes[0].updated);
}

TEST(Estimator, BandHoldsTheForce) {
  Rig rig;
  const Contact contact{.noise_std = 0.02};
  for (std::int64_t seq = 5; seq <= 20; ++seq) rig.Step(contact.Pack(seq));
  const Estimate& e = rig.estimate();
  const DataPack last = contact.Pack(20);
  const auto& u = last.u[99];
  const double truth = std::pow(u[0], 1.7) * (4.0 + 2.3 * u[1]);
  EXPECT_LT(e.y_lo, e.y_pred);
  EXPECT_GT(e.y_hi, e.y_pred);
  EXPECT_NEAR(e.y_pred, truth, 2.0 * (e.y_hi - e.y_lo));
  EXPECT_NEAR(e.y_rmse, contact.noise_std, 0.01) << "the posterior fits the pack down to the noise";
}

TEST(Estimator, ShownForceIsThatOfTheEstimatesOfThePackBeforeThePrevious) {
  Rig rig;
  const Contact contact;
  rig.Step(contact.Pack(20));
  const double k = rig.estimate().modes[0].marginal[0].ar_map, b = rig.estimate().modes[0].marginal[1].ar_map,
               p = rig.estimate().modes[0].marginal[2].ar_map;
  // Before the first estimate: the mean of the prior.
  for (const std::int64_t seq : {20, 21}) {
    if (seq == 21) rig.Step(contact.Pack(seq));
    const DataPack early = contact.Pack(seq);
    EXPECT_NEAR(rig.estimate().y_shown[0], std::pow(early.u[0][0], 1.5) * (2.5 + 2.5 * early.u[0][1]), 1e-9) << seq;
  }
  rig.Step(contact.Pack(22));
  const DataPack pack = contact.Pack(22);
  for (std::size_t n = 0; n < 100; ++n)
    EXPECT_NEAR(rig.estimate().y_shown[n], std::pow(pack.u[n][0], p) * (k + b * pack.u[n][1]), 1e-9) << n;
}

TEST(Estimator, BadPackChangesNothing) {
  const double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<DataPack> bad(5, Contact{}.Pack(12));
  bad[0].y[50] = kNan;
  bad[1].u[3][0] = HUGE_VAL;
  bad[2].num_samples = 257;
  bad[3].plant = SoftActuator::kInfo.plant;
  bad[4].num_inputs = 1;
  for (const DataPack& pack : bad) {
    Rig clean, disturbed;
    for (std::int64_t seq = 10; seq < 15; ++seq) {
      if (seq == 12) {
        const Estimate& e = disturbed.Step(pack);
        EXPECT_EQ(disturbed.status, Status::kBadPack);
        EXPECT_TRUE(e.modes[0].known);
        EXPECT_FALSE(e.modes[0].updated);
      }
      clean.Step(Contact{}.Pack(seq));
      disturbed.Step(Contact{}.Pack(seq));
      test::ExpectSameBits(clean.estimate(), disturbed.estimate());
    }
  }
}

TEST(Estimator, PackWithoutAnyFinitePosteriorKeepsWhatIsKnown) {
  Rig clean, disturbed;
  clean.Step(Contact{}.Pack(10));
  disturbed.Step(Contact{}.Pack(10));
  DataPack pack = Contact{}.Pack(11);
  pack.y.fill(1e200);  // finite, but its square is not
  disturbed.Step(pack);
  EXPECT_EQ(disturbed.status, Status::kNonFinite);
  EXPECT_TRUE(disturbed.estimate().modes[0].known);
  EXPECT_FALSE(disturbed.estimate().modes[0].updated);
  EXPECT_EQ(clean.Step(Contact{}.Pack(12)).modes[0].log_evidence,
            disturbed.Step(Contact{}.Pack(12)).modes[0].log_evidence);
}

TEST(Estimator, EveryIndexReinforcesWhatHoldsAndModifiesWhatChanged) {
  for (const MismatchIndex index : {MismatchIndex::kSignedMean, MismatchIndex::kRms, MismatchIndex::kLogPredictive}) {
    EstimatorSettings settings = BuiltinSettings("hunt_crossley");
    settings.forgetting.index = index;
    Rig rig(settings);
    for (std::int64_t seq = 10; seq <= 20; ++seq) {
      rig.Step(Contact{}.Pack(seq));
      EXPECT_EQ(rig.estimate().modes[0].decision, seq == 10 ? Decision::kModification : Decision::kReinforcement);
      test::ExpectUsable(rig.estimate().modes[0], settings);
    }
    rig.Step(Contact{.k = 8.0, .b = 5.0}.Pack(21));
    EXPECT_EQ(rig.estimate().modes[0].decision, Decision::kModification) << static_cast<int>(index);
  }
}

TEST(Estimator, DrawRulesGiveTheirNumbers) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = 1234;
  EXPECT_EQ(Rig(settings).Step(Contact{}.Pack(10)).modes[0].draws, 1234);
  settings.sampler.fixed_draws = SamplerSettings::kMinDraws;
  Rig smallest(settings);
  for (std::int64_t seq = 10; seq < 20; ++seq) {
    EXPECT_EQ(smallest.Step(Contact{}.Pack(seq)).modes[0].draws, SamplerSettings::kMinDraws);
    test::ExpectUsable(smallest.estimate().modes[0], settings);
  }
  settings.sampler.rule = DrawRule::kKMin;
  Rig k_min(settings);
  EXPECT_EQ(k_min.Step(Contact{}.Pack(10)).modes[0].draws, 14979);
  const ModeEstimate& second = k_min.Step(Contact{}.Pack(11)).modes[0];
  EXPECT_EQ(second.draws, second.k_min);
  settings.sampler.max_draws = 700;
  Rig capped(settings);
  EXPECT_EQ(capped.Step(Contact{}.Pack(10)).modes[0].draws, 700);
}

TEST(Estimator, UniformPriorsWorkToo) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  for (std::size_t d = 0; d < 3; ++d) settings.parameters[d].prior = PriorKind::kUniform;
  Rig rig(settings);
  for (std::int64_t seq = 1; seq <= 40; ++seq) rig.Step(Contact{}.Pack(seq));
  test::ExpectUsable(rig.estimate().modes[0], settings);
  EXPECT_NEAR(rig.estimate().modes[0].marginal[0].ar_ap, 4.0, 4.0 * rig.estimate().modes[0].marginal[0].sd);
}

TEST(Estimator, RejectsWrongSettings) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.noise[0].std = -1.0;
  EXPECT_THROW(Estimator{settings}, std::invalid_argument);
}

}  // namespace
}  // namespace armcmc::estimator_test
