#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "support/packs.hpp"

namespace armcmc::transition_test {
namespace {

/// Runs packs of a well excited contact; K halves in the middle of pack `change`, or between two packs.
class Contact {
 public:
  explicit Contact(bool partial_change = true)
      : estimator_(Settings(partial_change)), result_(estimator_.MakeResult()) {}

  const ModeEstimate& Run(int seq, const test::ContactTruth& truth, int old_samples, const test::ContactTruth& old) {
    const test::Motion motion{.depth = 1.0, .swing = 0.5, .hertz = 1.3, .phase = 0.0};
    test::Normal noise = normal_;
    DataPack pack = test::MakeContactPack(seq, motion, truth, 0.1, &normal_);
    const DataPack before = test::MakeContactPack(seq, motion, old, 0.1, &noise);
    for (std::size_t n = 0; n < static_cast<std::size_t>(old_samples); ++n) pack.y[n] = before.y[n];
    estimator_.Adjust(pack, 0, {}, result_.get());
    estimator_.Execute(*result_, estimate_.get());
    return estimate_->modes[0];
  }

  /// Spends the noise of a pack, so that the next one is the same as after Run().
  void Skip() { (void)test::MakeContactPack(1, {1.0, 0.5, 1.3, 0.0}, {}, 0.1, &normal_); }

 private:
  static EstimatorSettings Settings(bool partial_change) {
    EstimatorSettings s = BuiltinSettings("hunt_crossley");
    s.forgetting.partial_change = partial_change;
    return s;
  }

  test::Normal normal_{7};
  Estimator estimator_;
  std::unique_ptr<AdjustResult> result_;
  std::unique_ptr<Estimate> estimate_ = std::make_unique<Estimate>();
};

class HalvedStiffness : public ::testing::TestWithParam<int> {};

TEST_P(HalvedStiffness, IsFollowedWithinTwoPacksAndDampingAndExponentStay) {
  // GetParam(): samples of pack 31 that are still of the old plant; 0: the change is between two packs.
  const test::ContactTruth soft{.k = 2.0};
  Contact contact;
  for (int k = 1; k <= 30; ++k) contact.Run(k, {}, 0, {});
  contact.Run(31, soft, GetParam(), {});
  const ModeEstimate after = contact.Run(32, soft, 0, {});
  EXPECT_LE(after.marginal[0].q025, 2.0);
  EXPECT_GE(after.marginal[0].q975, 2.0);
  EXPECT_NEAR(after.marginal[0].ar_map, 2.0, 0.1);
  EXPECT_NEAR(after.marginal[1].ar_map, 2.3, 0.1);
  EXPECT_NEAR(after.marginal[2].ar_map, 1.7, 0.05);
  // B and p are known as well as before: a fresh start knows them ten times worse.
  EXPECT_LT(after.marginal[1].sd, 0.05);
  EXPECT_LT(after.marginal[2].sd, 0.02);
}

INSTANTIATE_TEST_SUITE_P(OldSamples, HalvedStiffness, ::testing::Values(0, 50, 99));

TEST(Transition, WithThePapersRuleAModificationForgetsEveryParameter) {
  const test::ContactTruth soft{.k = 2.0};
  Contact contact(false), fresh(false);
  for (int k = 1; k <= 30; ++k) contact.Run(k, {}, 0, {});
  for (int k = 1; k <= 30; ++k) fresh.Skip();
  const ModeEstimate& after = contact.Run(31, soft, 0, {});
  const ModeEstimate& alone = fresh.Run(31, soft, 0, {});
  EXPECT_EQ(after.decision, Decision::kModification);
  EXPECT_EQ(after.p_changed, 1.0);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(after.marginal[d].ar_ap, alone.marginal[d].ar_ap, 0.1 * alone.marginal[d].sd) << d;
    EXPECT_NEAR(after.marginal[d].sd, alone.marginal[d].sd, 0.1 * alone.marginal[d].sd) << d;
  }
}

TEST(Transition, WithoutAChangeNothingIsModified) {
  Contact contact;
  for (int k = 1; k <= 60; ++k) {
    const ModeEstimate& e = contact.Run(k, {}, 0, {});
    EXPECT_EQ(e.decision, k == 1 ? Decision::kModification : Decision::kReinforcement) << "pack " << k;
  }
}

TEST(Transition, AChangeOfEverythingIsStillFollowed) {
  Contact contact;
  const test::ContactTruth other{.k = 6.0, .b = 1.0, .p = 1.3};
  for (int k = 1; k <= 30; ++k) contact.Run(k, {}, 0, {});
  ModeEstimate e;
  for (int k = 31; k <= 45; ++k) e = contact.Run(k, other, 0, {});
  EXPECT_NEAR(e.marginal[0].ar_map, 6.0, 0.2);
  EXPECT_NEAR(e.marginal[1].ar_map, 1.0, 0.2);
  EXPECT_NEAR(e.marginal[2].ar_map, 1.3, 0.08);
}

}  // namespace
}  // namespace armcmc::transition_test
