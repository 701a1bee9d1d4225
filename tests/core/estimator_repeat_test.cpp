#include <gtest/gtest.h>

#include "core/estimator_rig.hpp"

namespace armcmc::estimator_repeat_test {
namespace {

using test::Contact;
using test::Rig;

TEST(Repeat, AnotherSeedGivesOtherDrawsOfTheSamePosterior) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  Rig a(settings);
  settings.sampler.seed += 1;
  Rig b(settings);
  for (std::int64_t seq = 5; seq <= 20; ++seq) {
    a.Step(Contact{}.Pack(seq));
    b.Step(Contact{}.Pack(seq));
  }
  for (std::size_t d = 0; d < 3; ++d) {
    const MarginalSummary &p = a.estimate().modes[0].marginal[d], &q = b.estimate().modes[0].marginal[d];
    EXPECT_NE(p.ar_ap, q.ar_ap);
    // Sixteen compressions deep, each with a Monte-Carlo error of about 1/sqrt(5000) sd.
    EXPECT_NEAR(p.ar_ap, q.ar_ap, 0.3 * p.sd);
    EXPECT_NEAR(p.sd / q.sd, 1.0, 0.2);
  }
}

TEST(Repeat, TwoEstimatorsDoNotShareState) {
  Rig alone, beside, other;
  for (std::int64_t seq = 10; seq <= 16; ++seq) {
    alone.Step(Contact{}.Pack(seq));
    other.Step(Contact{.k = 7.5, .b = 0.5, .p = 1.2, .seed = 9}.Pack(seq));
    beside.Step(Contact{}.Pack(seq));
    test::ExpectSameBits(alone.estimate(), beside.estimate());
  }
}

TEST(Repeat, SamePacksGiveTheSameBitsWithExecuteBehindAdjustInOtherSlots) {
  // The end of a contact, free motion, the next contact.
  Rig in_step;
  Estimator lagging(BuiltinSettings("hunt_crossley"));
  const auto estimate = std::make_unique<Estimate>();
  std::unique_ptr<AdjustResult> slots[2] = {lagging.MakeResult(), lagging.MakeResult()};
  (void)lagging.Adjust(Contact{}.Pack(36), 0, {}, slots[0].get());
  for (std::int64_t seq = 36; seq <= 70; ++seq) {
    in_step.Step(Contact{}.Pack(seq));
    (void)lagging.Adjust(Contact{}.Pack(seq + 1), 0, {}, slots[(seq + 1) % 2].get());
    lagging.Execute(*slots[seq % 2], estimate.get());
    test::ExpectSameBits(in_step.estimate(), *estimate);
  }
}

TEST(Repeat, AResultIsWholeBeforeItIsRemembered) {
  const EstimatorSettings models[] = {BuiltinSettings("hunt_crossley"), test::ActuatorSettings()};
  for (const EstimatorSettings& settings : models) {
    const auto pack = [&](std::int64_t seq) {
      return settings.model == "hunt_crossley" ? Contact{}.Pack(seq) : test::Actuator{}.Pack(seq, seq % 2 ? 60 : 100);
    };
    Rig whole(settings);
    Estimator in_parts(settings);
    const auto estimate = std::make_unique<Estimate>();
    const auto slot = in_parts.MakeResult();
    for (std::int64_t seq = 1; seq <= 12; ++seq) {
      whole.Step(pack(seq));
      (void)in_parts.Draw(pack(seq), 0, {}, slot.get());
      in_parts.Execute(*slot, estimate.get());
      if (seq % 3 != 0) in_parts.Remember({});  // else the next Draw() makes up for it
      test::ExpectSameBits(whole.estimate(), *estimate);
    }
  }
}

TEST(Repeat, ResetEqualsAFreshEstimator) {
  const EstimatorSettings models[] = {BuiltinSettings("hunt_crossley"), test::ActuatorSettings()};
  for (const EstimatorSettings& settings : models) {
    const auto pack = [&](std::int64_t seq) {
      return settings.model == "hunt_crossley" ? Contact{}.Pack(seq) : test::Actuator{}.Pack(seq, seq % 2 ? 60 : 100);
    };
    Rig used(settings), fresh(settings);
    for (std::int64_t seq = 1; seq <= 7; ++seq) used.Step(pack(seq));
    used.estimator.Reset();
    for (std::int64_t seq = 8; seq <= 12; ++seq) {
      used.Step(pack(seq));
      fresh.Step(pack(seq));
      test::ExpectSameBits(used.estimate(), fresh.estimate());
    }
  }
}

}  // namespace
}  // namespace armcmc::estimator_repeat_test
