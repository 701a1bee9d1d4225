#include <gtest/gtest.h>

#include <vector>

#include "core/effects/contact_series.hpp"
#include "core/estimator_rig.hpp"
#include "support/alloc_counter.hpp"

namespace armcmc::effect_estimator_test {
namespace {

using test::Catalogue;
using test::HiddenEffect;
using test::Rig;
using test::Series;

constexpr std::size_t kPack = 100;

/// A recording with noise of sd 0.1 N, cut into packs.
std::vector<DataPack> Packs(const std::vector<HiddenEffect>& effects, int packs, unsigned seed) {
  Series series(packs * static_cast<int>(kPack));
  test::Simulate(effects, &series);
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> noise(0.0, 0.1);
  for (double& f : series.f) f += noise(generator);
  std::vector<DataPack> out;
  out.reserve(static_cast<std::size_t>(packs));
  for (int k = 0; k < packs; ++k) out.push_back(series.Pack(k + 1, static_cast<std::size_t>(k) * kPack, kPack));
  return out;
}

EstimatorSettings Quick(EstimatorSettings settings) {
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = 6000;
  return settings;
}

/// Largest distance of the estimates from the truth over the last two thirds of the packs, in posterior standard
/// deviations.
double WorstDistance(const EstimatorSettings& settings, const std::vector<DataPack>& packs,
                     const std::vector<double>& truth) {
  Rig rig(settings);
  double worst = 0.0;
  for (std::size_t k = 0; k < packs.size(); ++k) {
    rig.Step(packs[k]);
    for (std::size_t d = 0; k >= packs.size() / 3 && d < truth.size(); ++d) {
      const MarginalSummary& m = rig.estimate().modes[0].marginal[d];
      worst = std::fmax(worst, std::fabs(m.ar_ap - truth[d]) / m.sd);
    }
  }
  return worst;
}

std::vector<double> Truth(const std::vector<HiddenEffect>& effects) {
  std::vector<double> truth{4.0, 2.3, 1.7};
  for (const HiddenEffect& e : effects) truth.insert(truth.end(), e.amplitude.begin(), e.amplitude.end());
  return truth;
}

TEST(EffectEstimator, EveryEffectIsRecoveredWhereTheBaseModelIsBiased) {
  for (const HiddenEffect& e : Catalogue()) {
    const auto packs = Packs({e}, 30, 3);
    const double with = WorstDistance(Quick(test::WithEffects({e})), packs, Truth({e}));
    EstimatorSettings base = Quick(BuiltinSettings("hunt_crossley"));
    base.forgetting.drift_share = 0.0;  // else its posterior is wide, as it should be of what does not stay
    const double without = WorstDistance(base, packs, Truth({}));
    EXPECT_LT(with, 4.0) << e.name;
    EXPECT_GT(without, 15.0) << e.name;
  }
}

TEST(EffectEstimator, IntervalsCoverTheTruthOverSeeds) {
  const auto all = Catalogue();
  const std::vector<HiddenEffect> effects{all[2], all[0]};  // Coulomb friction and a bias
  const std::vector<double> truth = Truth(effects);
  constexpr int kSeeds = 40;
  int covered = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Rig rig(Quick(test::WithEffects(effects)));
    for (const DataPack& pack : Packs(effects, 12, seed)) rig.Step(pack);
    for (std::size_t d = 0; d < truth.size(); ++d) {
      const MarginalSummary& m = rig.estimate().modes[0].marginal[d];
      covered += m.q025 <= truth[d] && truth[d] <= m.q975 ? 1 : 0;
    }
  }
  const double share = covered / (kSeeds * 5.0);
  EXPECT_GT(share, 0.88);
  EXPECT_LT(share, 1.0);
}

TEST(EffectEstimator, FreeMotionTellsTheBiasAndKeepsTheRest) {
  const std::vector<HiddenEffect> effects{Catalogue()[0]};
  auto packs = Packs(effects, 30, 5);
  EstimatorSettings at_rest = Quick(test::WithEffects(effects));
  at_rest.forgetting.drift_share = 0.0;  // else the seconds in the air count
  Rig rig(at_rest);
  for (const DataPack& pack : packs) rig.Step(pack);
  const ModeEstimate before = rig.estimate().modes[0];
  std::mt19937_64 generator(9);
  std::normal_distribution<double> noise(0.0, 0.1);
  for (std::int64_t seq = 31; seq <= 90; ++seq) {  // six seconds in the air
    DataPack free = packs.back();
    free.seq = seq;
    free.t_last_s += 0.1 * static_cast<double>(seq - 30);
    for (std::size_t n = 0; n < kPack; ++n) {
      free.u[n] = {-0.2, 0.0};
      free.y[n] = 0.7 + noise(generator);
    }
    rig.Step(free);
  }
  const ModeEstimate& after = rig.estimate().modes[0];
  EXPECT_LT(after.marginal[3].sd, 0.8 * before.marginal[3].sd) << "the air shows the bias";
  EXPECT_NEAR(after.marginal[3].ar_ap, 0.7, 4.0 * after.marginal[3].sd);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(after.marginal[d].ar_ap, before.marginal[d].ar_ap, 2.0 * before.marginal[d].sd) << d;
    EXPECT_LT(after.marginal[d].sd, 3.0 * before.marginal[d].sd) << d << ": nothing was forgotten in the air";
  }
  EXPECT_FALSE(rig.estimate().active);
  EXPECT_NEAR(rig.estimate().y_pred, 0.7, 0.1) << "the sensor shows its bias in the air too";
  EXPECT_NEAR(rig.estimate().y_shown[50], 0.7, 0.1);
}

/// Share of packs, once the drift may be known, whose 95 % interval holds a bias that drifts; the estimate at the
/// end.
struct DriftingBias {
  double inside = 0.0;
  ModeEstimate last;
};
DriftingBias FollowBias(double drift_share) {
  EstimatorSettings settings = Quick(test::WithEffects({Catalogue()[0]}));
  settings.forgetting.drift_share = drift_share;
  Rig rig(settings);
  test::Normal normal(4);
  const test::Motion motion{.depth = 0.4, .swing = 0.8, .hertz = 1.3, .phase = 0.0};
  const auto bias = [](double t) { return 0.2 + 0.1 * t; };
  DriftingBias out;
  constexpr int kPacks = 80, kKnown = 20;
  for (std::int64_t seq = 1; seq <= kPacks; ++seq) {
    const DataPack pack = test::FillContactPack(
        seq, [&](double t) { return motion.At(t); },
        [&](double t, const test::Place& at) {
          return test::ContactTruth{}.Force(at.x, at.v) + bias(t) + 0.1 * normal();
        });
    const MarginalSummary& m = rig.Step(pack).modes[0].marginal[3];
    const double truth = bias(pack.t_last_s - 0.05);  // in the middle of the pack: within it nothing drifts
    if (seq > kKnown) out.inside += m.q025 < truth && truth < m.q975 ? 1.0 / (kPacks - kKnown) : 0.0;
  }
  out.last = rig.estimate().modes[0];
  return out;
}

TEST(EffectEstimator, FollowsAnAmplitudeThatDrifts) {
  const DriftingBias follows = FollowBias(ForgettingSettings{}.drift_share), denied = FollowBias(0.0);
  EXPECT_GT(follows.inside, 0.88);
  EXPECT_LT(denied.inside, 0.7) << "the drift is too slow to need it";
  EXPECT_GT(follows.last.p_drifted, 0.9);
  EXPECT_GT(follows.last.drift_rate[3], 0.02) << "N/s";
  EXPECT_LT(follows.last.drift_rate[3], 0.4);
}

TEST(EffectEstimator, ReportsAmplitudesUnderTheirOwnNames) {
  const auto all = Catalogue();
  const Estimator estimator(test::WithEffects({all[2], all[12]}));
  ASSERT_EQ(estimator.num_reported(), 6);
  EXPECT_EQ(estimator.reported(2).name, "p");
  EXPECT_EQ(estimator.reported(3).name, "coulomb_friction_force");
  EXPECT_EQ(estimator.reported(3).unit, "N");
  EXPECT_EQ(estimator.reported(5).name, "periodic_disturbance_sine");
  EXPECT_EQ(estimator.num_modes(), 1);
}

TEST(EffectEstimator, ResetEqualsAFreshEstimatorToTheBit) {
  const auto all = Catalogue();
  for (const auto& effects : {std::vector<HiddenEffect>{all[3], all[8]}, std::vector<HiddenEffect>{all[6], all[7]}}) {
    const EstimatorSettings settings = Quick(test::WithEffects(effects));
    Rig used(settings), fresh(settings);
    const auto packs = Packs(effects, 9, 2);
    for (std::size_t k = 0; k < 4; ++k) used.Step(packs[k]);
    used.estimator.Reset();
    // The next pack follows the last one, and yet nothing of that is left.
    for (std::size_t k = 4; k < packs.size(); ++k) test::ExpectSameBits(used.Step(packs[k]), fresh.Step(packs[k]));
  }
}

TEST(EffectEstimator, ABadPackChangesNothing) {
  const auto all = Catalogue();
  const EstimatorSettings settings = Quick(test::WithEffects({all[8], all[7]}));
  Rig first(settings), second(settings);
  const auto packs = Packs({all[8], all[7]}, 4, 2);
  for (std::size_t k = 0; k < packs.size(); ++k) {
    if (k == 2) {
      DataPack bad = packs[k];
      bad.u[7][0] = std::nan("");
      first.Step(bad);
      EXPECT_EQ(first.status, Status::kBadPack);
      bad = packs[k];
      bad.u[7][0] = 1e308;
      bad.u[8][0] = -1e308;
      bad.seq = -1;
      first.Step(bad);
      EXPECT_EQ(first.status, Status::kBadPack);
    }
    first.Step(packs[k]);
    second.Step(packs[k]);
  }
  for (std::size_t d = 0; d < 5; ++d)
    EXPECT_EQ(first.estimate().modes[0].marginal[d].ar_ap, second.estimate().modes[0].marginal[d].ar_ap);
}

TEST(EffectEstimator, StepsDoNotTouchTheHeap) {
  if (!test::AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  const auto all = Catalogue();
  for (const auto& effects : {std::vector<HiddenEffect>{all[3], all[8], all[5]},
                              std::vector<HiddenEffect>{all[6], all[7], all[10], all[11], all[13]}}) {
    const auto packs = Packs(effects, 8, 2);
    Rig rig(Quick(test::WithEffects(effects)));
    const test::AllocCounter guard;
    for (const DataPack& pack : packs) rig.Step(pack);
    DataPack bad = packs.back();
    bad.num_samples = 0;
    rig.Step(bad);
    rig.estimator.Reset();
    rig.Step(packs[0]);
    EXPECT_EQ(guard.count() + guard.frees(), 0);
  }
}

}  // namespace
}  // namespace armcmc::effect_estimator_test
