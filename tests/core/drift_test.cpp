#include "armcmc/drift.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "armcmc/density_fit.hpp"
#include "core/estimator_rig.hpp"
#include "support/alloc_counter.hpp"

namespace armcmc::drift_test {
namespace {

using test::Rig;

constexpr double kPackDuration = test::kPackSamples * test::kSampleInterval;

EstimatorSettings Quick(double drift_share = ForgettingSettings{}.drift_share) {
  EstimatorSettings s = BuiltinSettings("hunt_crossley");
  s.forgetting.drift_share = drift_share;
  s.sampler.rule = DrawRule::kFixed;
  s.sampler.fixed_draws = 4000;
  return s;
}

/// A well excited contact whose parameters move at a constant speed from `from_s` to `to_s`.
class Contact {
 public:
  test::ContactTruth speed;  ///< Per second.
  test::ContactTruth start{};
  double from_s = 0.0, to_s = 1e9;

  explicit Contact(const test::ContactTruth& moves = {0.0, 0.0, 0.0}) : speed(moves) {}

  [[nodiscard]] test::ContactTruth At(double t) const {
    const double moved = std::clamp(t, from_s, to_s) - from_s;
    return {start.k + speed.k * moved, start.b + speed.b * moved, start.p + speed.p * moved};
  }
  /// Plant time of its end.
  [[nodiscard]] static double End(std::int64_t seq) { return static_cast<double>(seq) * kPackDuration; }

  DataPack Pack(std::int64_t seq) {
    constexpr test::Motion kMotion{.depth = 1.0, .swing = 0.5, .hertz = 1.3, .phase = 0.0};
    return test::FillContactPack(
        seq, [&](double t) { return kMotion.At(t); },
        [&](double t, const test::Place& at) { return At(t).Force(at.x, at.v) + 0.1 * normal_(); });
  }

 private:
  test::Normal normal_{7};
};

const test::ContactTruth kDrift{.k = 0.1, .b = -0.05, .p = 0.01};

TEST(Drift, OfAPlantAtRestIsUnlearnt) {
  Contact contact;
  Rig rig(Quick());
  for (std::int64_t seq = 1; seq <= 80; ++seq) {
    const ModeEstimate& e = rig.Step(contact.Pack(seq)).modes[0];
    EXPECT_EQ(e.decision, seq == 1 ? Decision::kModification : Decision::kReinforcement) << "pack " << seq;
  }
  const ModeEstimate& e = rig.estimate().modes[0];
  EXPECT_LT(e.p_drifted, 0.02);
  EXPECT_LT(e.drift_rate[0], 0.002) << "N/m^p per s";
}

TEST(Drift, IsFollowedAndItsRateLearnt) {
  Contact contact(kDrift);
  Rig rig(Quick()), at_rest(Quick(0.0));
  for (std::int64_t seq = 1; seq <= 80; ++seq) {
    const DataPack pack = contact.Pack(seq);
    rig.Step(pack);
    at_rest.Step(pack);
  }
  const ModeEstimate &e = rig.estimate().modes[0], &late = at_rest.estimate().modes[0];
  const test::ContactTruth truth = contact.At(contact.End(80));
  const std::array<double, 3> theta{truth.k, truth.b, truth.p};
  EXPECT_GT(e.p_drifted, 0.98);
  EXPECT_LT(e.p_changed, 0.01);
  EXPECT_GT(e.drift_rate[0], 0.3 * kDrift.k);
  EXPECT_LT(e.drift_rate[0], 3.0 * kDrift.k);
  double with = 0.0;
  double without = 0.0;
  for (std::size_t d = 0; d < 3; ++d) {
    const MarginalSummary& m = e.marginal[d];
    EXPECT_LT(std::fabs(m.ar_ap - theta[d]), 3.0 * m.sd) << d;
    with += std::fabs(m.ar_ap - theta[d]) / theta[d];
    without += std::fabs(late.marginal[d].ar_ap - theta[d]) / theta[d];
  }
  EXPECT_LT(with, 0.5 * without);
}

TEST(Drift, OfOneParameterIsNotTakenForADriftOfAll) {
  Contact contact({.k = kDrift.k, .b = 0.0, .p = 0.0});
  const EstimatorSettings settings = Quick();
  Rig rig(settings);
  for (std::int64_t seq = 1; seq <= 120; ++seq) rig.Step(contact.Pack(seq));
  const ModeEstimate& e = rig.estimate().modes[0];
  EXPECT_GT(e.p_drifted, 0.98);
  const auto rate = [&](std::size_t d) { return e.drift_rate[d] / settings.parameters[d].sd; };
  EXPECT_LT(rate(1), 0.2 * rate(0));
  EXPECT_LT(rate(2), 0.2 * rate(0));
  const test::ContactTruth truth = contact.At(contact.End(120));
  EXPECT_NEAR(e.marginal[0].ar_ap, truth.k, 3.0 * e.marginal[0].sd);
  EXPECT_NEAR(e.marginal[1].ar_ap, truth.b, 3.0 * e.marginal[1].sd);
}

TEST(Drift, ThatStopsIsUnlearnt) {
  Contact contact(kDrift);
  contact.to_s = 4.0;
  Rig rig(Quick());
  double most = 0.0;
  for (std::int64_t seq = 1; seq <= 160; ++seq) {
    rig.Step(contact.Pack(seq));
    most = std::fmax(most, rig.estimate().modes[0].p_drifted);
  }
  EXPECT_GT(most, 0.98);
  EXPECT_LT(rig.estimate().modes[0].p_drifted, 0.5);
}

TEST(Drift, ThatStopsInTheAirIsFoundAtTheNextContact) {
  constexpr std::int64_t kLast = 60;
  for (const double times : {1.0, 2.0, 4.0})
    for (const std::int64_t lost : {10, 20, 40})
      for (const double share : {0.25, 0.5, 0.75}) {
        Contact contact({times * kDrift.k, times * kDrift.b, times * kDrift.p});
        contact.to_s = contact.End(kLast) + share * contact.End(lost);
        Rig rig(Quick());
        for (std::int64_t seq = 1; seq <= kLast; ++seq) rig.Step(contact.Pack(seq));
        ASSERT_GT(rig.estimate().modes[0].p_drifted, 0.9);
        const test::ContactTruth truth = contact.At(contact.to_s);
        const std::array<double, 3> theta{truth.k, truth.b, truth.p};
        for (std::int64_t seq = kLast + lost + 1; seq <= kLast + lost + 4; ++seq) {
          SCOPED_TRACE(testing::Message() << times << " times, " << share << " of " << lost << " packs, pack " << seq);
          const ModeEstimate& e = rig.Step(contact.Pack(seq)).modes[0];
          EXPECT_EQ(e.decision, Decision::kReinforcement) << "where it stopped was to be expected";
          for (std::size_t d = 0; d < 3; ++d)
            EXPECT_LT(std::fabs(e.marginal[d].ar_ap - theta[d]), 3.0 * e.marginal[d].sd) << d;
        }
        EXPECT_LT(rig.estimate().modes[0].p_drifted, 0.5);
      }
}

TEST(Drift, AJumpOnTopIsFollowedAndTheDriftGoesOn) {
  Contact contact(kDrift);
  Rig rig(Quick());
  constexpr double kJump = -2.0;
  for (std::int64_t seq = 1; seq <= 72; ++seq) {
    DataPack pack = contact.Pack(seq);
    for (std::size_t n = 0; seq > 60 && n < test::kPackSamples; ++n) {
      const double t = contact.End(seq - 1) + static_cast<double>(n) * test::kSampleInterval;
      pack.y[n] += kJump * std::pow(pack.u[n][0], contact.At(t).p);
    }
    const ModeEstimate& e = rig.Step(pack).modes[0];
    if (seq != 62 && seq != 72) continue;
    const double truth = contact.At(contact.End(seq)).k + kJump;
    EXPECT_LT(std::fabs(e.marginal[0].ar_ap - truth), 4.0 * e.marginal[0].sd) << "pack " << seq;
    EXPECT_LT(e.marginal[0].sd, 0.15) << "pack " << seq;
    if (seq == 72) {
      EXPECT_GT(e.p_drifted, 0.9);
    }
  }
}

// After a jump the draws are widened by the velocities that were expected, relative to their spread: a few effective
// ones have none, and would be moved to the bounds.
TEST(Drift, AfterAJumpAFewEffectiveDrawsStayWhereTheyAre) {
  constexpr double kJump = -2.0;
  int few = 0, moved = 0;
  for (const int count : {SamplerSettings::kMinDraws, 4000}) {
    Contact contact(kDrift);
    EstimatorSettings settings = Quick();
    settings.sampler.fixed_draws = count;
    Rig rig(settings);
    for (std::int64_t seq = 1; seq <= 45; ++seq) {
      DataPack pack = contact.Pack(seq);
      for (std::size_t n = 0; seq > 40 && n < test::kPackSamples; ++n) pack.y[n] += kJump * pack.u[n][0];
      rig.Step(pack);
      const ModeDraws& draws = rig.result->modes[0];
      if (seq <= 40 || draws.decision != Decision::kModification) continue;
      if (draws.kish_ess < kMinimumEss) {
        ++few;
        EXPECT_FALSE(draws.moves) << "pack " << seq << " of " << count << " draws";
      } else {
        moved += draws.moves ? 1 : 0;
      }
    }
  }
  EXPECT_GT(few, 0);
  EXPECT_GT(moved, 0);
}

TEST(Drift, WithoutItTimeHasNoSay) {
  // The paper's rule: what was learnt persists or changes, however long ago it was.
  EstimatorSettings paper = Quick(0.0);
  paper.forgetting.partial_change = false;
  Contact contact;
  Rig soon(paper), late(paper);
  for (std::int64_t seq = 1; seq <= 20; ++seq) {
    DataPack pack = contact.Pack(seq);
    soon.Step(pack);
    if (seq == 20) pack.t_last_s += 3600.0;
    late.Step(pack);
  }
  const ModeEstimate &a = soon.estimate().modes[0], &b = late.estimate().modes[0];
  EXPECT_EQ(a.p_drifted, 0.0);
  EXPECT_EQ(a.drift_rate[0], 0.0);
  for (std::size_t d = 0; d < 3; ++d)
    EXPECT_TRUE(test::SameBits(a.marginal[d].ar_ap, b.marginal[d].ar_ap) &&
                test::SameBits(a.marginal[d].sd, b.marginal[d].sd));
}

TEST(Drift, AContactThatReturnsLaterMeetsAWiderPrior) {
  // All parameters have moved a little while nobody looked, which after a tenth of a second is a change.
  Contact contact;
  Rig soon(Quick()), late(Quick());
  for (std::int64_t seq = 1; seq <= 30; ++seq) {
    const DataPack pack = contact.Pack(seq);
    soon.Step(pack);
    late.Step(pack);
  }
  Contact moved;
  moved.start = {4.3, 2.1, 1.75};
  DataPack pack = moved.Pack(31);
  soon.Step(pack);
  pack.t_last_s += 600.0;
  late.Step(pack);
  const ModeEstimate &changed = soon.estimate().modes[0], &drifted = late.estimate().modes[0];
  EXPECT_EQ(changed.decision, Decision::kModification);
  EXPECT_EQ(drifted.decision, Decision::kReinforcement);
  EXPECT_GT(drifted.p_drifted, 0.9);
  EXPECT_LT(std::fabs(drifted.marginal[0].ar_ap - 4.3), 4.0 * drifted.marginal[0].sd);
}

TEST(Drift, FreeMotionWidensWhatIsPublished) {
  Contact drifts(kDrift), rests;
  Rig rig(Quick()), at_rest(Quick());
  for (std::int64_t seq = 1; seq <= 40; ++seq) {
    rig.Step(drifts.Pack(seq));
    at_rest.Step(rests.Pack(seq));
  }
  const ModeEstimate last = rig.estimate().modes[0], last_at_rest = at_rest.estimate().modes[0];
  ASSERT_GT(last.p_drifted, 0.5);
  const auto air = [](std::int64_t seq) {
    return test::FillContactPack(
        seq,
        [](double) {
          return test::Place{-1.0, 0.0};
        },
        [](double, const test::Place&) { return 0.0; });
  };
  ModeEstimate before = last;
  for (std::int64_t seq = 41; seq <= 60; ++seq) {
    const ModeEstimate held = rig.Step(air(seq)).modes[0];
    ASSERT_FALSE(held.updated);
    for (std::size_t d = 0; d < 3; ++d) {
      const MarginalSummary &was = before.marginal[d], &m = held.marginal[d];
      EXPECT_GT(m.sd, was.sd) << "parameter " << d << ", pack " << seq;
      EXPECT_LT(m.q025, was.q025);
      EXPECT_GT(m.q975, was.q975);
      EXPECT_EQ(m.ar_ap, last.marginal[d].ar_ap);
      EXPECT_EQ(m.q50, last.marginal[d].q50);
    }
    before = held;
  }
  // Two seconds at the speed that was learnt.
  const double gone = before.drift_rate[0] * 20 * kPackDuration;
  const double widened = std::sqrt(std::pow(before.marginal[0].sd, 2) - std::pow(last.marginal[0].sd, 2));
  EXPECT_GT(widened, 0.5 * gone);
  EXPECT_LT(widened, 2.0 * gone);
  // A pack that is no good says nothing of the time; an hour makes the prior of it, not more.
  DataPack bad = air(61);
  bad.num_samples = -1;
  rig.Step(bad);
  EXPECT_TRUE(test::SameBits(rig.estimate().modes[0].marginal[0].sd, before.marginal[0].sd));
  DataPack late = air(62);
  late.t_last_s += 3600.0;
  const ModeEstimate& forgotten = rig.Step(late).modes[0];
  const EstimatorSettings settings = Quick();
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_GT(forgotten.marginal[d].sd, before.marginal[d].sd);
    EXPECT_GE(forgotten.marginal[d].q025, settings.parameters[d].lower);
    EXPECT_LE(forgotten.marginal[d].q975, settings.parameters[d].upper);
  }
  at_rest.Step(air(41));
  for (std::size_t d = 0; d < 3; ++d) {
    const MarginalSummary &m = at_rest.estimate().modes[0].marginal[d], &was = last_at_rest.marginal[d];
    for (const auto part : {&MarginalSummary::ar_map, &MarginalSummary::ar_ap, &MarginalSummary::sd,
                            &MarginalSummary::q025, &MarginalSummary::q50, &MarginalSummary::q975})
      EXPECT_TRUE(test::SameBits(m.*part, was.*part)) << d;
  }
}

TEST(Drift, ARestartGoesOnToTheBitAndAnOlderSnapshotIsTaken) {
  Contact contact(kDrift);
  Rig whole(Quick()), resumed(Quick()), older(Quick());
  for (std::int64_t seq = 1; seq <= 50; ++seq) whole.Step(contact.Pack(seq));
  ASSERT_GT(whole.estimate().modes[0].p_drifted, 0.9);
  std::vector<std::byte> adjusted(Estimator::kSnapshotBytes), executed(Estimator::kSnapshotBytes);
  adjusted.resize(whole.estimator.SaveAdjusted(adjusted));
  executed.resize(whole.estimator.SaveExecuted(executed));
  ASSERT_TRUE(resumed.estimator.Restore(adjusted, executed));
  constexpr std::size_t kFilter = 1 + 2 * 3 + 3 * 9;  // numbers of three parameters
  constexpr std::size_t kDriftBytes = 1 + (2 + Drift::kSlots * Drift::NumHypotheses(3) * kFilter) * sizeof(double);
  ASSERT_TRUE(older.estimator.Restore(std::span(adjusted).first(adjusted.size() - kDriftBytes), executed));
  EXPECT_FALSE(older.estimator.Restore(std::span(adjusted).first(adjusted.size() - kDriftBytes + 1), executed));
  ASSERT_TRUE(older.estimator.Restore(std::span(adjusted).first(adjusted.size() - kDriftBytes), executed));
  for (std::int64_t seq = 51; seq <= 56; ++seq) {
    const DataPack pack = contact.Pack(seq);
    whole.Step(pack);
    resumed.Step(pack);
    older.Step(pack);
    test::ExpectSameBits(whole.estimate(), resumed.estimate());
    EXPECT_LT(older.estimate().modes[0].p_drifted, seq == 51 ? 0.2 : 1.0) << "learnt anew";
  }
}

TEST(Drift, ABankOfOtherHypothesesOrFewerFiltersIsLearntAnew) {
  constexpr std::size_t kFilter = 1 + 2 * 3 + 3 * 9;  // numbers of three parameters
  constexpr std::size_t kHypotheses = static_cast<std::size_t>(Drift::NumHypotheses(3));
  constexpr std::size_t kBank = 1 + (2 + Drift::kSlots * kHypotheses * kFilter) * sizeof(double);
  Contact contact(kDrift);
  Rig rig(Quick());
  for (std::int64_t seq = 1; seq <= 50; ++seq) rig.Step(contact.Pack(seq));
  std::vector<std::byte> adjusted(Estimator::kSnapshotBytes), executed(Estimator::kSnapshotBytes);
  adjusted.resize(rig.estimator.SaveAdjusted(adjusted) - kBank);
  executed.resize(rig.estimator.SaveExecuted(executed));
  const DataPack next = contact.Pack(51);
  for (const auto& [kind, slots] : {std::pair{2, 6}, {3, 8}, {4, 11}}) {
    std::vector<std::byte> older = adjusted;
    older.push_back(static_cast<std::byte>(kind));
    older.resize(older.size() + (2 + static_cast<std::size_t>(slots) * (kHypotheses - 2) * kFilter) * sizeof(double));
    Rig resumed(Quick());
    ASSERT_TRUE(resumed.estimator.Restore(older, executed)) << kind;
    resumed.Step(next);
    EXPECT_TRUE(resumed.estimate().modes[0].known) << kind;
    EXPECT_LT(resumed.estimate().modes[0].p_drifted, 0.2) << kind;
    older.pop_back();
    EXPECT_FALSE(Rig(Quick()).estimator.Restore(older, executed)) << kind;
  }
}

TEST(Drift, WhatIsBelievedOfItOutlivesARestartInTheAir) {
  Contact contact(kDrift);
  Rig whole(Quick()), resumed(Quick()), older(Quick());
  for (std::int64_t seq = 1; seq <= 40; ++seq) whole.Step(contact.Pack(seq));
  const ModeEstimate last = whole.estimate().modes[0];
  ASSERT_GT(last.p_drifted, 0.5);
  std::vector<std::byte> adjusted(Estimator::kSnapshotBytes), executed(Estimator::kSnapshotBytes);
  adjusted.resize(whole.estimator.SaveAdjusted(adjusted));
  executed.resize(whole.estimator.SaveExecuted(executed));
  constexpr std::size_t kDriftBytes = (1 + 3) * sizeof(double);
  ASSERT_TRUE(resumed.estimator.Restore(adjusted, executed));
  ASSERT_TRUE(older.estimator.Restore(adjusted, std::span(executed).first(executed.size() - kDriftBytes)));
  const DataPack air = test::FillContactPack(
      41,
      [](double) {
        return test::Place{-1.0, 0.0};
      },
      [](double, const test::Place&) { return 0.0; });
  resumed.Step(air);
  older.Step(air);
  const ModeEstimate &held = resumed.estimate().modes[0], &unknown = older.estimate().modes[0];
  EXPECT_FALSE(held.updated);
  EXPECT_EQ(held.p_drifted, last.p_drifted);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(held.drift_rate[i], last.drift_rate[i]) << i;
  EXPECT_TRUE(unknown.known);
  EXPECT_EQ(unknown.p_drifted, 0.0) << "learnt anew";
}

TEST(Drift, AllocatesNothing) {
  if (!test::AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  Contact contact(kDrift);
  Rig rig(Quick());
  std::vector<DataPack> packs;
  for (std::int64_t seq = 1; seq <= 40; ++seq) packs.push_back(contact.Pack(seq));
  const test::AllocCounter guard;
  for (const DataPack& pack : packs) rig.Step(pack);
  EXPECT_EQ(guard.count() + guard.frees(), 0);
  EXPECT_GT(rig.estimate().modes[0].p_drifted, 0.5) << "else little was tried";
}

}  // namespace
}  // namespace armcmc::drift_test
