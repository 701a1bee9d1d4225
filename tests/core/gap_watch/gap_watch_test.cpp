#include "armcmc/gap_watch/gap_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "core/estimator_rig.hpp"
#include "core/gap_watch/gap_rig.hpp"
#include "support/alloc_counter.hpp"

namespace armcmc::gap_watch_test {
namespace {

using test::BaseForce;
using test::ContactSample;
using test::GapRig;
using test::MakeNoise;
using test::NoiseLaw;
using test::SampleAt;
using test::TruthAlone;

constexpr double kMinute = 60.0;
constexpr const char* kNoiseLaws[] = {"white", "ar", "student", "uneven"};

TEST(GapWatch, IsSilentWhenNothingIsMissing) {
  // 4 x 10 minutes. The rate allows 0.01 an hour, so one alarm here is a fault.
  for (const char* law : kNoiseLaws)
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      GapRig rig;
      EXPECT_EQ(rig.Run(5.0 * kMinute, TruthAlone, MakeNoise(law, seed)), 0.0)
          << law << ' ' << seed << ": " << rig.watch().state().where.view();
      EXPECT_GE(rig.watch().state().num_blocks, 23);
    }
}

TEST(GapWatch, BetsDoNotPayWhenNothingIsMissing) {
  // E[exp(l z - l^2 / 2)] <= 1 is what the rate of false alarms rests on: without any tolerance, for every noise law.
  for (const char* law : kNoiseLaws) {
    std::array<double, kMaxGapChecks> sum{}, largest{};
    int blocks = 0;
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
      GapRig rig(0.0);
      std::int64_t seen = 0;
      rig.Run(2.0 * kMinute, TruthAlone, MakeNoise(law, 100 + seed), [&](const GapState& state) {
        if (state.num_blocks == seen) return;
        seen = state.num_blocks;
        ++blocks;
        for (std::size_t c = 0; c < kMaxGapChecks; ++c) {
          const CheckScore& score = rig.watch().scores()[c];
          for (const double sign : {1.0, -1.0}) {
            sum[c] += 0.5 * std::exp(sign * score.z - score.margin - 0.5);
            largest[c] = std::max(largest[c], std::fabs(score.z));
          }
        }
      });
    }
    ASSERT_GE(blocks, 200);
    // The standard deviation of one bet on a normal score is 1.3; half of it by symmetry.
    for (std::size_t c = 0; c < kMaxGapChecks; ++c) {
      EXPECT_LT(sum[c] / blocks, 1.0 + 4.0 * 1.0 / std::sqrt(blocks)) << law << " check " << c;
      EXPECT_LT(largest[c], 5.0) << law << " check " << c;
    }
  }
}

TEST(GapWatch, DoesNotNeedTheNoiseLevel) {
  for (const double told : {0.03, 0.3}) {
    GapRig rig;
    rig.told.noise_std[0] = told;
    EXPECT_EQ(rig.Run(3.0 * kMinute, TruthAlone, MakeNoise("white", 3)), 0.0) << told;
  }
}

TEST(GapWatch, TakesADriftForWhatItIs) {
  GapRig rig;
  const auto drifting = [](const ContactSample& s) {
    const double share = s.t / 60.0;
    return BaseForce(s.x, s.v, 4.0 + 1.5 * share, 2.3 - 0.8 * share, 1.7 - 0.25 * share);
  };
  EXPECT_EQ(rig.Run(kMinute, drifting, MakeNoise("white", 4)), 0.0) << rig.watch().state().where.view();
}

/// A contact that grows stiffer and softer within half a minute.
double Breathing(const ContactSample& s) {
  const double share = std::sin(2.0 * M_PI * s.t / 30.0);
  return BaseForce(s.x, s.v, 4.0 + 1.2 * share, 2.3 - 0.6 * share, 1.7 - 0.15 * share);
}

TEST(GapWatch, TakesADriftWhoseSpeedChangesForWhatItIsWhenTheEstimatorFollowsIt) {
  GapRig denies, follows;
  follows.drifts = true;
  EXPECT_GT(denies.Run(kMinute, Breathing, MakeNoise("white", 4)), 0.0) << "the drift is too slow to matter";
  EXPECT_EQ(follows.Run(5.0 * kMinute, Breathing, MakeNoise("white", 4)), 0.0) << follows.watch().state().where.view();
}

TEST(GapWatch, HasTheEstimatorTellItOfDrift) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = 1000;
  test::Rig rig(settings);
  const GapRig packs;
  const NoiseLaw noise = MakeNoise("white", 4);
  for (std::int64_t seq = 1; seq <= 380; ++seq) rig.Step(packs.Pack(seq, Breathing, noise));
  EXPECT_EQ(rig.estimate().gap.num_blocks, 2);
  EXPECT_FALSE(rig.estimate().gap.suspected) << rig.estimate().gap.where.view();
}

TEST(GapWatch, TakesAStepForWhatItIsWhenTheEstimatorSawIt) {
  const auto stepping = [](const ContactSample& s) {
    return BaseForce(s.x, s.v, std::fmod(s.t, 26.0) < 14.0 ? 4.0 : 2.0);
  };
  const auto seen = [](double t) {
    const double place = std::fmod(t, 26.0);
    return (place > 14.0 && place < 14.15) || (place < 0.15 && t > 1.0);
  };
  GapRig rig;
  EXPECT_EQ(rig.Run(3.0 * kMinute, stepping, MakeNoise("white", 5), {}, seen), 0.0) << rig.watch().state().where.view();
}

struct Missing {
  const char* name;
  test::ForceLaw force;
};

TEST(GapWatch, FindsWhatIsMissing) {
  // Each about half the noise in size once the parameters have taken what they can.
  const std::vector<Missing> all = {
      {"force bias", [](const ContactSample& s) { return TruthAlone(s) + 0.07; }},
      {"Coulomb friction", [](const ContactSample& s) { return TruthAlone(s) + 0.08 * std::tanh(s.v / 0.02); }},
      {"viscous friction", [](const ContactSample& s) { return TruthAlone(s) + 0.15 * s.v; }},
      {"inertia", [](const ContactSample& s) { return TruthAlone(s) + 0.08 * s.a; }},
      {"dead time",
       [](const ContactSample& s) {
         const ContactSample late = SampleAt(s.t - 0.04);
         return BaseForce(late.x, late.v);
       }},
      {"contact offset", [](const ContactSample& s) { return BaseForce(s.x - 0.03, s.v); }},
      {"adhesion",
       [](const ContactSample& s) {
         return TruthAlone(s) - (s.x >= 0.0 && s.v < 0.0 ? 0.4 * std::exp(-s.x / 0.2) : 0.0);
       }},
      {"disturbance of 7 Hz",
       [](const ContactSample& s) { return TruthAlone(s) + 0.07 * std::sin(2.0 * M_PI * 7.0 * s.t); }},
      {"disturbance of 45 Hz",
       [](const ContactSample& s) { return TruthAlone(s) + 0.07 * std::sin(2.0 * M_PI * 45.0 * s.t); }},
  };
  for (const Missing& missing : all)
    for (const auto& [law, drifts] : {std::pair{"white", false}, {"student", false}, {"white", true}}) {
      GapRig rig;
      rig.drifts = drifts;  // a plant may do so and lack something
      const double alarm = rig.Run(kMinute, missing.force, MakeNoise(law, 6));
      EXPECT_GT(alarm, 0.0) << missing.name << ", " << law;
      EXPECT_GT(rig.watch().state().log_evidence, rig.watch().state().log_threshold) << missing.name;
      EXPECT_GT(rig.watch().state().share, 0.0) << missing.name;
      EXPECT_LE(rig.watch().state().share, 1.0) << missing.name;
    }
}

TEST(GapWatch, SaysWhere) {
  GapRig rig;
  rig.Run(
      kMinute, [](const ContactSample& s) { return TruthAlone(s) + (s.x < 0.0 ? (s.v > 0.0 ? 0.1 : -0.1) : 0.0); },
      MakeNoise("white", 7));
  EXPECT_EQ(rig.watch().state().where.view(), "free_direction");
  EXPECT_EQ(rig.watch().state().since_seq, 1);
}

TEST(GapWatch, SaysSinceWhen) {
  GapRig rig;
  const double alarm = rig.Run(
      3.0 * kMinute, [](const ContactSample& s) { return TruthAlone(s) + (s.t > 100.0 && s.v > 0.0 ? 0.15 : 0.0); },
      MakeNoise("white", 8));
  EXPECT_GT(alarm, 100.0);
  EXPECT_LT(alarm, 160.0);
  EXPECT_NEAR(static_cast<double>(rig.watch().state().since_seq), 1000.0, 250.0);
}

TEST(GapWatch, JoinsShortPacks) {
  GapRig rig;
  rig.samples = 10;
  EXPECT_GT(rig.Run(
                kMinute, [](const ContactSample& s) { return TruthAlone(s) + 0.1 * s.v; }, MakeNoise("white", 9)),
            0.0);
  GapRig silent;
  silent.samples = 30;
  EXPECT_EQ(silent.Run(2.0 * kMinute, TruthAlone, MakeNoise("ar", 9)), 0.0);
  EXPECT_GE(silent.watch().state().num_blocks, 7);
}

TEST(GapWatch, OutlivesLossesAndRestarts) {
  GapRig rig;
  const auto noise = MakeNoise("white", 10);
  for (std::int64_t seq = 1; seq <= 2000; ++seq) {
    if (seq % 17 == 0) continue;
    if (seq == 700) rig.run_id = 2;
    rig.watch().Step(rig.Pack(seq, TruthAlone, noise), rig.told, false);
  }
  EXPECT_GT(rig.watch().state().num_blocks, 10);
  EXPECT_FALSE(rig.watch().state().suspected);
  rig.watch().Reset();
  EXPECT_EQ(rig.watch().state().num_blocks, 0);
  EXPECT_TRUE(rig.watch().state().watched);
}

TEST(GapWatch, AMadEstimateAlarmsNobody) {
  // It decides where to linearise, no more; nothing here may turn into a NaN.
  GapRig rig;
  rig.told.theta[0] = {8.0, 0.0, 1.0};
  rig.Run(kMinute, TruthAlone, MakeNoise("white", 11));
  EXPECT_TRUE(std::isfinite(rig.watch().state().log_evidence));
  GapRig unknown;
  unknown.told.known[0] = false;
  EXPECT_EQ(unknown.Run(kMinute, TruthAlone, MakeNoise("white", 11)), 0.0);
}

TEST(GapWatch, StaysFiniteWithoutNoise) {
  for (const double scale : {1.0, 1e-30, 1e-160}) {
    GapRig rig;
    rig.Run(
        kMinute, [scale](const ContactSample& s) { return scale * TruthAlone(s); },
        [](const ContactSample&) { return 0.0; });
    EXPECT_TRUE(std::isfinite(rig.watch().state().log_evidence)) << scale;
    EXPECT_TRUE(std::isfinite(rig.watch().state().share)) << scale;
  }
  GapRig rig;
  rig.told.noise_std[0] = 1e-12;
  rig.Run(
      kMinute, [](const ContactSample&) { return 0.0; }, [](const ContactSample&) { return 0.0; });
  EXPECT_TRUE(std::isfinite(rig.watch().state().log_evidence));
}

TEST(GapWatch, CanBeSwitchedOff) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.gap_watch.enabled = false;
  GapWatch watch(settings, 0, simd::Best(), settings.gap_watch.false_alarm_rate);
  const GapRig rig;
  watch.Step(rig.Pack(1, TruthAlone, MakeNoise("white", 1)), rig.told, false);
  EXPECT_FALSE(watch.state().watched);
}

TEST(GapWatch, AllocatesNothing) {
  if (!test::AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  GapRig rig;
  const auto noise = MakeNoise("white", 12);
  auto pack = std::make_unique<DataPack>();
  long calls = 0;
  for (std::int64_t seq = 1; seq <= 400; ++seq) {
    *pack = rig.Pack(
        seq, [](const ContactSample& s) { return TruthAlone(s) + 0.1; }, noise);
    const test::AllocCounter guard;
    rig.watch().Step(*pack, rig.told, seq % 50 == 0);
    calls += guard.count() + guard.frees();
  }
  EXPECT_EQ(calls, 0);
  EXPECT_TRUE(rig.watch().state().suspected);
}

}  // namespace
}  // namespace armcmc::gap_watch_test
