#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/estimator_rig.hpp"
#include "support/packs.hpp"

namespace armcmc::estimator_deadline_test {
namespace {

using test::Contact;
using test::Rig;

/// A clock that moves on by a fixed time whenever it is read.
struct SteppingClock {
  explicit SteppingClock(Nanos step) : step_ns(step) {}
  mutable Nanos now_ns = 1'000'000'000;
  Nanos step_ns;
  [[nodiscard]] ClockRef Ref() const noexcept {
    return {[](const void* context) noexcept ARMCMC_NONBLOCKING {
              const auto* clock = static_cast<const SteppingClock*>(context);
              return clock->now_ns += clock->step_ns;
            },
            this};
  }
};

/// Every pack with another budget, so that the number of draws runs from the least to the full.
Nanos BudgetOf(std::int64_t seq) { return (seq * 7) % 48 * 1'000; }

void ExpectRepeatable(const EstimatorSettings& settings, const std::vector<DataPack>& packs) {
  Rig live(settings), replay(settings);
  const SteppingClock clock(1'000);
  int truncated = 0;
  for (const DataPack& pack : packs) {
    live.Step(pack, clock.now_ns + BudgetOf(pack.seq), clock.Ref());
    DrawLimits limits = kNoDrawLimits;
    for (std::size_t m = 0; m < kMaxModes; ++m) {
      const ModeEstimate& mode = live.estimate().modes[m];
      if (!mode.updated) continue;
      limits[m] = mode.draws;
      truncated += mode.truncated ? 1 : 0;
    }
    replay.Step(pack, 0, {}, limits);
    SCOPED_TRACE("pack " + std::to_string(pack.seq) + ", draws " + std::to_string(limits[0]));
    test::ExpectSameBits(live.estimate(), replay.estimate());
    if (::testing::Test::HasFailure()) return;  // what follows would repeat it
  }
  EXPECT_GT(truncated, static_cast<int>(packs.size()) / 4) << "the budgets must cut";
}

TEST(Deadline, DrawLimitsRepeatATruncatedRunToTheBit) {
  std::vector<DataPack> packs;
  for (std::int64_t seq = 1; seq <= 40; ++seq) packs.push_back(Contact{}.Pack(seq));
  ExpectRepeatable(BuiltinSettings("hunt_crossley"), packs);
}

TEST(Deadline, DrawLimitsRepeatATruncatedRunOfTwoModesToTheBit) {
  std::vector<DataPack> packs;
  for (std::int64_t seq = 1; seq <= 20; ++seq) packs.push_back(test::Actuator{}.Pack(seq, 60));
  ExpectRepeatable(test::ActuatorSettings(), packs);
}

/// Short packs of a plant that changes: pilots of up to seven rounds.
std::vector<DataPack> PacksOfLongPilots() {
  std::vector<DataPack> packs;
  test::Normal normal(11);
  for (std::int64_t seq = 1; seq <= 120; ++seq) {
    const test::ContactTruth truth = seq % 8 >= 5 ? test::ContactTruth{.k = 2.0, .b = 1.15} : test::ContactTruth{};
    packs.push_back(test::MakeContactPack(seq, {1.6, 1.4, 0.66, 0.0}, truth, 0.1, &normal, 100, 1e-4));
  }
  return packs;
}

TEST(Deadline, DrawLimitsRepeatAPilotThatWasCutShortToTheBit) {
  ExpectRepeatable(BuiltinSettings("hunt_crossley"), PacksOfLongPilots());
}

TEST(Deadline, DrawLimitsRepeatRunsOfFewDrawsToTheBit) {
  // The pilot and what follows it in haste are a quarter of the draws and more.
  for (const int draws : {1500, 2000, 2500, 4000}) {
    SCOPED_TRACE(draws);
    EstimatorSettings settings = BuiltinSettings("hunt_crossley");
    settings.sampler.rule = DrawRule::kFixed;
    settings.sampler.fixed_draws = draws;
    ExpectRepeatable(settings, PacksOfLongPilots());
  }
}

TEST(Deadline, BudgetOfACertainLengthCutsTheDrawsAndSaysSo) {
  Rig rig;
  const SteppingClock clock(1'000);
  const Estimate& e = rig.Step(Contact{}.Pack(10), clock.now_ns + 20'000, clock.Ref());
  EXPECT_EQ(rig.status, Status::kTruncated);
  EXPECT_TRUE(e.modes[0].truncated);
  EXPECT_LT(e.modes[0].draws, 14979);
  EXPECT_GE(e.modes[0].draws, SamplerSettings::kMinDraws);
  EXPECT_EQ(e.modes[0].k_min, 14979) << "what the formula asks for, not what was made";
  test::ExpectUsable(e.modes[0], rig.estimator.settings());
}

TEST(Deadline, MoreTimeNeverMeansFewerDraws) {
  int before = 0;
  for (Nanos budget = 0; budget <= 70'000; budget += 5'000) {
    Rig rig;
    const SteppingClock clock(1'000);
    const int draws = rig.Step(Contact{}.Pack(10), clock.now_ns + budget, clock.Ref()).modes[0].draws;
    EXPECT_GE(draws, before) << budget;
    before = draws;
  }
  EXPECT_EQ(before, 14979);
}

TEST(Deadline, InThePastStillGivesAValidTruncatedEstimate) {
  Rig rig;
  const SteppingClock clock(1'000);
  const Contact contact;
  for (std::int64_t seq = 10; seq <= 30; ++seq) {
    const Estimate& e = rig.Step(contact.Pack(seq), clock.now_ns - 1'000'000'000, clock.Ref());
    ASSERT_EQ(rig.status, Status::kTruncated) << ToString(rig.status);
    EXPECT_TRUE(e.modes[0].updated);
    EXPECT_TRUE(e.modes[0].truncated);
    EXPECT_LT(e.modes[0].draws, 5000);
    test::ExpectUsable(e.modes[0], rig.estimator.settings());
  }
  const double truth[] = {contact.k, contact.b, contact.p};
  for (std::size_t d = 0; d < 3; ++d) {
    const MarginalSummary& m = rig.estimate().modes[0].marginal[d];
    EXPECT_NEAR(m.ar_ap, truth[d], 5.0 * m.sd) << d;
  }
}

TEST(Deadline, ModesThatShareAPackShareTheTime) {
  Rig rig(test::ActuatorSettings());
  const SteppingClock clock(1'000);
  const Estimate& e = rig.Step(test::Actuator{}.Pack(1, 50), clock.now_ns + 40'000, clock.Ref());
  EXPECT_EQ(rig.status, Status::kTruncated);
  EXPECT_GT(e.modes[0].draws, 1000);
  EXPECT_GT(e.modes[1].draws, e.modes[0].draws / 3) << "the first mode must not eat what the second needs";
}

TEST(Deadline, DrawLimitsBelowTheLeastAreRaisedToIt) {
  Rig rig;
  DrawLimits limits{};
  const Estimate& e = rig.Step(Contact{}.Pack(10), 0, {}, limits);
  EXPECT_GE(e.modes[0].draws, SamplerSettings::kMinDraws);
  test::ExpectUsable(e.modes[0], rig.estimator.settings());
}

/// A clock that moves on by 1 us whenever it is read, and stands still for a second at one of its readings.
struct StallingClock {
  mutable Nanos now_ns = 1'000'000'000;
  mutable int readings = 0;
  int stall_at = -1;
  [[nodiscard]] ClockRef Ref() const noexcept {
    return {[](const void* context) noexcept ARMCMC_NONBLOCKING {
              const auto* clock = static_cast<const StallingClock*>(context);
              return clock->now_ns += clock->readings++ == clock->stall_at ? 1'000'000'000 : 1'000;
            },
            this};
  }
};

/// A clock for which the fit at the beginning of a pack takes as long as twenty rounds of draws.
struct SlowFitClock {
  static constexpr Nanos kRead = 1'000, kSlow = 20'000;
  mutable Nanos now_ns = 1'000'000'000;
  mutable int reads = 0;
  [[nodiscard]] ClockRef Ref() const noexcept {
    return {[](const void* context) noexcept ARMCMC_NONBLOCKING {
              const auto* clock = static_cast<const SlowFitClock*>(context);
              return clock->now_ns += ++clock->reads <= 4 ? kSlow : kRead;
            },
            this};
  }
};

TEST(Deadline, AFitThatTakesLongDoesNotCutAPackThatHasTheTime) {
  // A plant that changes: the pilot's draws fail, and a ridge of anchors is needed, which costs less than that fit.
  test::Normal normal(11);
  Rig unhurried, rig;
  SlowFitClock first, second;
  int modifications = 0;
  for (std::int64_t seq = 1; seq <= 40; ++seq) {
    const test::ContactTruth truth = seq % 8 >= 5 ? test::ContactTruth{.k = 2.0, .b = 1.15} : test::ContactTruth{};
    const DataPack pack = test::MakeContactPack(seq, {1.6, 1.4, 0.66, 0.0}, truth, 0.1, &normal, 100, 1e-4);
    constexpr Nanos kMargin = 10 * SlowFitClock::kRead, kNever = 1'000'000'000;
    first.reads = second.reads = 0;
    const Nanos start = first.now_ns;
    unhurried.Step(pack, start + kNever, first.Ref());
    const bool learns = seq <= 16;  // what a ridge takes: the first few packs need none
    const Nanos time = learns ? kNever : first.now_ns - start + kMargin;
    const Estimate& e = rig.Step(pack, second.now_ns + time, second.Ref());
    modifications += e.modes[0].decision == Decision::kModification ? 1 : 0;
    EXPECT_FALSE(e.modes[0].truncated) << "pack " << seq;
  }
  EXPECT_GT(modifications, 3);
}

TEST(Deadline, AStallOfTheMachineDoesNotCutThePacksAfterIt) {
  constexpr Nanos kBudget = 1'000'000;  // ten times what a pack takes on this clock
  StallingClock counting;
  Rig calm;
  for (std::int64_t seq = 10; seq <= 12; ++seq)
    calm.Step(Contact{}.Pack(seq), counting.now_ns + kBudget, counting.Ref());
  // At every reading of the third pack in turn: also at those where the end of a step is measured.
  for (int reading = counting.readings / 3 * 2; reading < counting.readings; ++reading) {
    Rig rig;
    StallingClock clock;
    clock.stall_at = reading;
    for (std::int64_t seq = 10; seq <= 15; ++seq) {
      rig.Step(Contact{}.Pack(seq), clock.now_ns + kBudget, clock.Ref());
      if (seq > 12) {
        EXPECT_NE(rig.status, Status::kTruncated) << "pack " << seq << ", stall at reading " << reading;
      }
    }
  }
}

}  // namespace
}  // namespace armcmc::estimator_deadline_test
