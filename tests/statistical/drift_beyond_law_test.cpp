// Drift of what is not a parameter of the law: the amplitude of an added effect, and the level of the noise.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "core/effects/contact_series.hpp"
#include "core/estimator_rig.hpp"

namespace armcmc::drift_beyond_law_test {
namespace {

constexpr int kPacks = 180;
constexpr test::ContactTruth kContact{};

/// From 0 to 1 between 2 s and 18 s.
double Moved(double t) { return std::clamp((t - 2.0) / 16.0, 0.0, 1.0); }

EstimatorSettings Quick(EstimatorSettings settings) {
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = 5000;
  return settings;
}

/// Of the estimates of one quantity.
struct Score {
  double error = 0.0, in50 = 0.0, in95 = 0.0;

  void Add(const MarginalSummary& m, double truth) {
    error += std::fabs(m.ar_ap - truth);
    in50 += m.q25 <= truth && truth <= m.q75 ? 1.0 : 0.0;
    in95 += m.q025 <= truth && truth <= m.q975 ? 1.0 : 0.0;
  }
  void Divide(double packs) {
    for (double* sum : {&error, &in50, &in95}) *sum /= packs;
  }
};

/// @param measured  (t, place, normal) -> N.
/// @param judge     (estimate, time of the end of the pack), for every pack that taught something.
template <class Measured, class Judge>
int Follow(test::Rig* rig, int seed, const Measured& measured, const Judge& judge) {
  rig->estimator.Reset();
  test::Normal normal(static_cast<std::uint64_t>(seed));
  int packs = 0;
  for (int k = 1; k <= kPacks; ++k) {
    DataPack pack = test::FillContactPack(k, &test::Contact::At, [&](double t, const test::Place& at) {
      return kContact.Force(at.x, at.v) + measured(t, at, &normal);
    });
    pack.seq += seed * kPacks;  // draws of its own
    const ModeEstimate& e = rig->Step(pack).modes[0];
    if (!e.updated || !e.known) continue;
    ++packs;
    judge(e, pack.t_last_s);
  }
  return packs;
}

/// Of the coefficient of a friction c v that grows from 0.3 to 1.2 N s/m.
/// @param prior_sd  N s/m
Score ScoreOfFriction(double prior_sd, double drift_share = ForgettingSettings{}.drift_share) {
  constexpr int kSeeds = 16;
  EstimatorSettings settings = Quick(test::WithEffects({{"viscous_friction", {0.5}, {}}}));
  settings.forgetting.drift_share = drift_share;
  settings.effects[0].amplitudes[0].sd = prior_sd;
  settings.effects[0].amplitudes[0].upper = 5.0;
  test::Rig rig(settings);
  const auto coefficient = [](double t) { return 0.3 + 0.9 * Moved(t); };
  Score score;
  int packs = 0;
  for (int seed = 1; seed <= kSeeds; ++seed)
    packs += Follow(
        &rig, seed,
        [&](double t, const test::Place& at, test::Normal* normal) {
          return coefficient(t) * at.v + 0.1 * (*normal)();
        },
        [&](const ModeEstimate& e, double t) { score.Add(e.marginal[3], coefficient(t)); });
  score.Divide(packs);
  return score;
}

TEST(DriftBeyondLaw, TheAmplitudeOfAnEffectIsFollowed) {
  const Score with = ScoreOfFriction(1.0), without = ScoreOfFriction(1.0, 0.0);
  RecordProperty("in95", std::to_string(with.in95));
  RecordProperty("in50", std::to_string(with.in50));
  RecordProperty("error", std::to_string(with.error / without.error));
  EXPECT_GT(with.in95, 0.88);
  EXPECT_GT(with.in50, 0.38);
  EXPECT_LT(with.in50, 0.65);
  EXPECT_LT(with.error, 0.5 * without.error);
  EXPECT_LT(without.in95, 0.5) << "without drift in the prior";
}

TEST(DriftBeyondLaw, IntervalsAreALittleTooNarrowForWhatMovesFast) {
  // A tenth of the prior's standard deviation per second: the rates that are expected of one alone are slower.
  const Score fast = ScoreOfFriction(0.5);
  RecordProperty("in95", std::to_string(fast.in95));
  EXPECT_GT(fast.in95, 0.84);
  EXPECT_GT(fast.in50, 0.38);
}

TEST(DriftBeyondLaw, TheNoiseOfASensorThatWarmsUpIsFollowed) {
  constexpr int kSeeds = 24;
  EstimatorSettings settings = Quick(BuiltinSettings("hunt_crossley"));
  settings.noise[0].estimate_std = true;
  test::Rig rig(settings);
  const auto level = [](double t) { return 0.1 + 0.2 * Moved(t); };
  const std::array<double, 3> truth{kContact.k, kContact.b, kContact.p};
  std::array<Score, 3> scores;
  double mean = 0.0, square = 0.0;
  int packs = 0, modifications = 0;
  for (int seed = 1; seed <= kSeeds; ++seed)
    packs += Follow(
        &rig, seed, [&](double t, const test::Place&, test::Normal* normal) { return level(t) * (*normal)(); },
        [&](const ModeEstimate& e, double t) {
          const double off = std::log(e.noise_std / level(t));
          mean += off;
          square += off * off;
          modifications += e.decision == Decision::kModification && t > 1.0 ? 1 : 0;
          for (std::size_t d = 0; d < 3; ++d) scores[d].Add(e.marginal[d], truth[d]);
        });
  mean /= packs;
  RecordProperty("mean", std::to_string(mean));
  RecordProperty("rms", std::to_string(std::sqrt(square / packs)));
  // A pack alone has a standard error of 7 %.
  EXPECT_LT(std::fabs(mean), 0.03) << "of the logarithm of the level";
  EXPECT_LT(std::sqrt(square / packs), 0.07);
  EXPECT_EQ(modifications, 0) << "the plant stays";
  for (std::size_t d = 0; d < 3; ++d) {
    scores[d].Divide(packs);
    RecordProperty("in95_" + std::to_string(d), std::to_string(scores[d].in95));
    EXPECT_GT(scores[d].in95, 0.88) << d;
  }
}

}  // namespace
}  // namespace armcmc::drift_beyond_law_test
