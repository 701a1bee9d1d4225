#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "armcmc/parameter_space.hpp"
#include "core/estimator_rig.hpp"

namespace armcmc::estimator_noise_test {
namespace {

using test::Contact;
using test::Rig;

EstimatorSettings Settings(NoiseKind kind, bool estimate_std) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  settings.noise[0].kind = kind;
  settings.noise[0].estimate_std = estimate_std;
  return settings;
}

TEST(EstimatedNoise, IntervalsCoverTheTrueScale) {
  const EstimatorSettings settings = Settings(NoiseKind::kGaussian, true);
  const ParameterSpace space(settings, settings.noise[0]);
  constexpr double kTruth = 0.2;  // the prior is centred on 0.1
  constexpr int kPacks = 60;
  int covered = 0;
  double sum = 0.0;
  for (int trial = 0; trial < kPacks; ++trial) {
    Rig rig(settings);
    const Contact contact{.noise_std = kTruth, .seed = static_cast<std::uint64_t>(100 + trial)};
    sum += rig.Step(contact.Pack(15)).modes[0].noise_std;
    const ModeDraws& draws = rig.result->modes[0];
    double below = 0.0;
    for (int k = 0; k < draws.draws; ++k)
      if (std::exp(space.Theta(space.dim - 1, draws.u[3][k])) < kTruth) below += draws.weight[k];
    covered += below > 0.05 && below < 0.95 ? 1 : 0;
  }
  // 90 % intervals: 54 of 60 expected, standard deviation 2.3.
  EXPECT_GE(covered, 54 - 8);
  EXPECT_LT(covered, 60);
  // One pack of 100 samples has a standard error of 1/sqrt(200) of the scale.
  EXPECT_NEAR(sum / kPacks, kTruth, kTruth * 4.0 / std::sqrt(200.0 * kPacks) + 0.004);
}

TEST(EstimatedNoise, FollowsItsLevel) {
  // A pack of 100 samples knows the level to 7 %, what is carried on from earlier packs to 10 %: together 5.8 %.
  constexpr double kRelativeSd = 0.058;
  Rig rig(Settings(NoiseKind::kGaussian, true));
  for (std::int64_t seq = 5; seq <= 20; ++seq) rig.Step(Contact{.noise_std = 0.25}.Pack(seq));
  EXPECT_NEAR(rig.estimate().modes[0].noise_std, 0.25, 4.0 * kRelativeSd * 0.25);
  const double k_sd = rig.estimate().modes[0].marginal[0].sd;
  // Twice the noise from one pack to the next: followed, and what is known of the stiffness stays known.
  for (std::int64_t seq = 21; seq <= 35; ++seq) rig.Step(Contact{.noise_std = 0.5}.Pack(seq));
  EXPECT_NEAR(rig.estimate().modes[0].noise_std, 0.5, 4.0 * kRelativeSd * 0.5);
  EXPECT_LT(rig.estimate().modes[0].marginal[0].sd, 1.5 * k_sd);
}

// Whether all has changed or the noise alone is a matter of densities far out in the tails, of what was known and of
// P_0: few candidates would leave it to chance.
TEST(EstimatedNoise, AJumpOfItsLevelIsJudgedAlikeByAllSeeds) {
  double least = 1.0, most = 0.0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    EstimatorSettings settings = Settings(NoiseKind::kGaussian, true);
    settings.sampler.seed = seed;
    Rig rig(settings);
    for (std::int64_t seq = 5; seq <= 20; ++seq) rig.Step(Contact{.noise_std = 0.25}.Pack(seq));
    const double changed = rig.Step(Contact{.noise_std = 0.5}.Pack(21)).modes[0].p_changed;
    least = std::fmin(least, changed);
    most = std::fmax(most, changed);
  }
  EXPECT_GT(least, 0.2);
  EXPECT_LT(most, 0.5);
}

TEST(EstimatedNoise, IntervalsHoldTheScaleOfASensorThatWarmsUp) {
  EstimatorSettings settings = Settings(NoiseKind::kGaussian, true);
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = 1000;
  settings.gap_watch.enabled = false;
  const ParameterSpace space(settings, settings.noise[0]);
  const test::Motion motion{.depth = 1.0, .swing = 0.5, .hertz = 1.3, .phase = 0.0};
  test::Normal normal(3);
  Rig rig(settings);
  const auto sd = [](double t) { return 0.1 * std::exp2(t / 60.0); };
  double inside95 = 0.0, inside50 = 0.0, drifted = 0.0;
  constexpr int kPacks = 600;
  for (std::int64_t seq = 1; seq <= kPacks; ++seq) {
    const DataPack pack = test::FillContactPack(
        seq, [&](double t) { return motion.At(t); },
        [&](double t, const test::Place& at) { return test::ContactTruth{}.Force(at.x, at.v) + sd(t) * normal(); });
    const ModeEstimate& mode = rig.Step(pack).modes[0];
    const ModeDraws& draws = rig.result->modes[0];
    const double truth = sd(pack.t_last_s - 0.05);  // in the middle of the pack
    double below = 0.0;
    for (int k = 0; k < draws.draws; ++k)
      if (std::exp(space.Theta(space.dim - 1, draws.u[3][k])) < truth) below += draws.weight[k];
    inside95 += std::fabs(below - 0.5) < 0.475 ? 1.0 / kPacks : 0.0;
    inside50 += std::fabs(below - 0.5) < 0.25 ? 1.0 / kPacks : 0.0;
    drifted += mode.p_drifted / kPacks;
  }
  // What a pack adds outweighs what is carried on, so that packs are nearly independent: binomial, 0.9 and 2 %.
  EXPECT_GT(inside95, 0.90);
  EXPECT_LT(inside95, 0.995);
  EXPECT_GT(inside50, 0.42);
  EXPECT_LT(inside50, 0.62);
  EXPECT_LT(drifted, 0.1) << "the parameters stay";
}

TEST(HeavyTails, OutliersDoNotMoveTheEstimate) {
  for (const NoiseKind kind : {NoiseKind::kStudentT, NoiseKind::kMixture}) {
    EstimatorSettings settings = Settings(kind, false);
    settings.noise[0].std = 0.1;
    Rig rig(settings);
    std::mt19937_64 generator(8);
    const Contact contact;
    for (std::int64_t seq = 1; seq <= 40; ++seq) {
      DataPack pack = contact.Pack(seq);
      for (std::size_t n = 0; n < 100; ++n)
        if (generator() % 20 == 0) pack.y[n] += 3.0;  // always upward: least squares would be biased
      rig.Step(pack);
    }
    const double truth[] = {contact.k, contact.b, contact.p};
    for (std::size_t d = 0; d < 3; ++d) {
      const MarginalSummary& m = rig.estimate().modes[0].marginal[d];
      EXPECT_NEAR(m.ar_ap, truth[d], 5.0 * m.sd + 0.03) << static_cast<int>(kind) << " parameter " << d;
    }
  }
}

TEST(NoiseMean, IsTakenOffTheForce) {
  EstimatorSettings settings = Settings(NoiseKind::kGaussian, false);
  settings.noise[0].mean = 0.5;
  Rig biased(settings), plain;
  for (std::int64_t seq = 10; seq <= 20; ++seq) {
    DataPack pack = Contact{}.Pack(seq);
    plain.Step(pack);
    for (double& y : pack.y) y += 0.5;
    biased.Step(pack);
  }
  for (std::size_t d = 0; d < 3; ++d) {
    const MarginalSummary &a = biased.estimate().modes[0].marginal[d], &b = plain.estimate().modes[0].marginal[d];
    EXPECT_NEAR(a.ar_ap, b.ar_ap, 1e-3 * b.sd);  // the same up to rounding, that may tip a draw
  }
}

TEST(Rho, OldSamplesOfAPackCountLess) {
  const DataPack good = Contact{}.Pack(20);
  DataPack spoilt = good;
  // Nonsense in the first ten samples; exp(-0.05 * 90) leaves a hundredth of it.
  for (std::size_t n = 0; n < 10; ++n) spoilt.y[n] += 5.0;
  double harm[2];
  for (const std::size_t forgets : {0u, 1u}) {
    EstimatorSettings settings = BuiltinSettings("hunt_crossley");
    settings.forgetting.rho = forgets ? 0.05 : 0.0;
    Rig with(settings), without(settings);
    harm[forgets] = std::fabs(with.Step(spoilt).modes[0].log_evidence - without.Step(good).modes[0].log_evidence);
  }
  EXPECT_GT(harm[0], 100.0 * harm[1]);
}

}  // namespace
}  // namespace armcmc::estimator_noise_test
