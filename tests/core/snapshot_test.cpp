#include "armcmc/snapshot.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "core/estimator_rig.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "support/alloc_counter.hpp"

namespace armcmc::snapshot_test {
namespace {

using test::Contact;
using test::Rig;

struct Saved {
  std::vector<std::byte> adjusted, executed;
};

Saved SaveOf(const Estimator& estimator) {
  std::vector<std::byte> bytes(Estimator::kSnapshotBytes);
  Saved saved;
  const std::size_t first = estimator.SaveAdjusted(bytes);
  EXPECT_GT(first, 0U);
  saved.adjusted.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(first));
  const std::size_t second = estimator.SaveExecuted(bytes);
  EXPECT_GT(second, 0U);
  saved.executed.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(second));
  return saved;
}

TEST(Snapshot, ARestoredEstimatorGoesOnToTheBit) {
  EstimatorSettings sampled_noise = BuiltinSettings("hunt_crossley");
  sampled_noise.noise[0].estimate_std = true;
  for (const EstimatorSettings& settings : {BuiltinSettings("hunt_crossley"), sampled_noise}) {
    Rig whole(settings), resumed(settings);
    for (std::int64_t seq = 10; seq <= 20; ++seq) whole.Step(Contact{}.Pack(seq));
    const Saved saved = SaveOf(whole.estimator);
    ASSERT_TRUE(resumed.estimator.Restore(saved.adjusted, saved.executed));
    // Contact, free motion, contact again, an abrupt change.
    std::vector<DataPack> packs;
    for (const std::int64_t seq : {21, 22, 23, 55, 64, 65}) packs.push_back(Contact{}.Pack(seq));
    packs.push_back(Contact{.k = 8.0, .b = 0.5}.Pack(66));
    packs.push_back(Contact{.k = 8.0, .b = 0.5}.Pack(67));
    for (const DataPack& pack : packs) {
      whole.Step(pack);
      resumed.Step(pack);
      test::ExpectSameBits(whole.estimate(), resumed.estimate());
    }
  }
}

TEST(Snapshot, HoldsBothModesOfTheActuator) {
  Rig whole(test::ActuatorSettings()), resumed(test::ActuatorSettings()), fresh(test::ActuatorSettings());
  for (std::int64_t seq = 1; seq <= 6; ++seq) whole.Step(test::Actuator{}.Pack(seq, 50));
  const Saved saved = SaveOf(whole.estimator);
  ASSERT_TRUE(resumed.estimator.Restore(saved.adjusted, saved.executed));
  // A lost pack, so that the predictor starts from the measurements in both.
  const DataPack next = test::Actuator{}.Pack(9, 50);
  whole.Step(next);
  resumed.Step(next);
  fresh.Step(next);
  for (std::size_t m = 0; m < 2; ++m) {
    const ModeEstimate &a = whole.estimate().modes[m], &b = resumed.estimate().modes[m];
    EXPECT_EQ(b.decision, Decision::kReinforcement);
    EXPECT_EQ(fresh.estimate().modes[m].decision, Decision::kModification) << "who knows nothing starts from the prior";
    EXPECT_TRUE(test::SameBits(a.log_evidence, b.log_evidence));
    EXPECT_TRUE(test::SameBits(a.marginal[0].ar_ap, b.marginal[0].ar_ap));
  }
}

TEST(Snapshot, WhatNothingWasLearntFromIsASnapshotToo) {
  Rig fresh, resumed;
  const Saved saved = SaveOf(fresh.estimator);
  ASSERT_TRUE(resumed.estimator.Restore(saved.adjusted, saved.executed));
  fresh.Step(Contact{}.Pack(10));
  resumed.Step(Contact{}.Pack(10));
  test::ExpectSameBits(fresh.estimate(), resumed.estimate());
}

TEST(Snapshot, KeepsTheAlarmOfTheGapWatch) {
  Rig rig, resumed;
  // A force that no parameter explains: a bias of ten noise scales in free motion and contact.
  for (std::int64_t seq = 1; seq <= 600 && !rig.estimate().gap.suspected; ++seq) {
    DataPack pack = Contact{}.Pack(seq);
    for (std::size_t n = 0; n < test::kPackSamples; ++n) pack.y[n] += 1.0;
    rig.Step(pack);
  }
  ASSERT_TRUE(rig.estimate().gap.suspected) << "the rig is too weak";
  const Saved saved = SaveOf(rig.estimator);
  ASSERT_TRUE(resumed.estimator.Restore(saved.adjusted, saved.executed));
  resumed.Step(Contact{}.Pack(601));
  EXPECT_TRUE(resumed.estimate().gap.suspected);
  EXPECT_EQ(resumed.estimate().gap.where.view(), rig.estimate().gap.where.view());
  EXPECT_EQ(resumed.estimate().gap.alarm_seq, rig.estimate().gap.alarm_seq);
  EXPECT_EQ(resumed.estimate().gap.log_evidence, rig.estimate().gap.log_evidence);
}

TEST(Snapshot, RefusesEveryTruncationAndForgetsEverything) {
  Rig rig;
  for (std::int64_t seq = 10; seq <= 13; ++seq) rig.Step(Contact{}.Pack(seq));
  const Saved saved = SaveOf(rig.estimator);
  Rig victim, fresh;
  const auto cut = [](const std::vector<std::byte>& bytes, std::size_t size) {
    return std::span<const std::byte>(bytes).first(size);
  };
  for (std::size_t size = 0; size < saved.adjusted.size(); size += 97)
    EXPECT_FALSE(victim.estimator.Restore(cut(saved.adjusted, size), saved.executed)) << size;
  for (std::size_t size = 0; size < saved.executed.size(); size += 97)
    EXPECT_FALSE(victim.estimator.Restore(saved.adjusted, cut(saved.executed, size))) << size;
  auto longer = saved.adjusted;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(victim.estimator.Restore(longer, saved.executed));
  victim.Step(Contact{}.Pack(20));
  fresh.Step(Contact{}.Pack(20));
  test::ExpectSameBits(victim.estimate(), fresh.estimate());
}

TEST(Snapshot, NoDamagedByteCanHarm) {
  Rig rig;
  for (std::int64_t seq = 10; seq <= 13; ++seq) rig.Step(Contact{}.Pack(seq));
  const Saved saved = SaveOf(rig.estimator);
  Rig victim;
  std::mt19937_64 random(5);
  int refused = 0, taken = 0;
  for (int i = 0; i < 400; ++i) {
    Saved damaged = saved;
    auto& part = i % 2 == 0 ? damaged.adjusted : damaged.executed;
    part[random() % part.size()] = static_cast<std::byte>(random() & 0xffU);
    if (!victim.estimator.Restore(damaged.adjusted, damaged.executed)) {
      ++refused;
      continue;
    }
    ++taken;
    if (taken % 20 != 0) continue;
    victim.Step(Contact{}.Pack(14));  // under a sanitizer: the state that was restored does no harm
    EXPECT_TRUE(std::isfinite(victim.estimate().y_rmse));
  }
  EXPECT_GT(refused, 0);
  EXPECT_GT(taken, 0) << "without a checksum a changed digit is a number like any other";
}

TEST(Snapshot, SavingAndRestoringDoNotTouchTheHeap) {
  if (!test::AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  Rig rig;
  for (std::int64_t seq = 10; seq <= 13; ++seq) rig.Step(Contact{}.Pack(seq));
  const Saved saved = SaveOf(rig.estimator);
  std::vector<std::byte> bytes(Estimator::kSnapshotBytes);
  long calls = 0;
  {
    const test::AllocCounter guard;
    (void)rig.estimator.SaveAdjusted(bytes);
    (void)rig.estimator.SaveExecuted(bytes);
    (void)rig.estimator.Restore(saved.adjusted, saved.executed);
    calls = guard.count() + guard.frees();
  }
  EXPECT_EQ(calls, 0);
}

TEST(Snapshot, SaysWhenTheMemoryIsTooSmall) {
  Rig rig;
  rig.Step(Contact{}.Pack(10));
  std::vector<std::byte> bytes(100);
  EXPECT_EQ(rig.estimator.SaveAdjusted(bytes), 0U);
  EXPECT_EQ(rig.estimator.SaveExecuted(bytes), 0U);
}

TEST(SnapshotIdentity, IsThatOfTheQuestionAndNotOfTheSampler) {
  const EstimatorSettings base = BuiltinSettings("hunt_crossley");
  const auto identity_with = [&](const std::function<void(EstimatorSettings*)>& change) {
    EstimatorSettings s = base;
    change(&s);
    return SnapshotIdentity(s);
  };
  const std::uint64_t same = SnapshotIdentity(base);
  EXPECT_EQ(identity_with([](auto* s) { s->sampler.seed = 7; }), same);
  EXPECT_EQ(identity_with([](auto* s) { s->sampler.max_draws = 5000; }), same);
  EXPECT_EQ(identity_with([](auto* s) { s->forgetting.threshold = 2.0; }), same);
  EXPECT_NE(identity_with([](auto* s) { s->parameters[0].mean += 1e-9; }), same);
  EXPECT_NE(identity_with([](auto* s) { s->parameters[2].upper += 1.0; }), same);
  EXPECT_NE(identity_with([](auto* s) { s->noise[0].estimate_std = !s->noise[0].estimate_std; }), same);
  EXPECT_NE(identity_with([](auto* s) { s->noise[0].kind = NoiseKind::kLaplace; }), same);
  EXPECT_NE(identity_with([](auto* s) {
              s->effects[0] = MakeEffect(HuntCrossley::kInfo, "force_bias");
              s->num_effects = 1;
            }),
            same);
  EXPECT_NE(identity_with([](auto* s) { s->constants[0] += 1.0; }), same);
  EXPECT_NE(identity_with([](auto* s) { s->regress_rate = true; }), same);
  EXPECT_NE(SnapshotIdentity(BuiltinSettings("soft_actuator")),
            SnapshotIdentity(BuiltinSettings("soft_actuator_excited")));
}

}  // namespace
}  // namespace armcmc::snapshot_test
