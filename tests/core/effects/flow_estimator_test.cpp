#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/effects/valve_series.hpp"
#include "core/estimator_rig.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "plants/soft_actuator/effects.hpp"
#include "plants/soft_actuator/model.hpp"
#include "support/alloc_counter.hpp"

namespace armcmc::flow_estimator_test {
namespace {

using test::FlowCase;
using test::FlowCases;
using test::Measured;
using test::Rig;
using test::ValveSeries;
using test::WithFlowEffects;
using ::testing::AllOf;
using ::testing::HasSubstr;

EstimatorSettings Quick(EstimatorSettings settings) {
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = 6000;
  return settings;
}

double Distance(const MarginalSummary& m, double truth) { return std::fabs(m.ar_ap - truth) / m.sd; }

/// Largest distance of g and theta2 of the valves from the truth after all packs, in posterior standard deviations.
double BaseDistance(const Rig& rig, const ValveSeries& series, const std::vector<std::size_t>& modes) {
  double worst = 0.0;
  for (const std::size_t m : modes) {
    const auto& marginal = rig.estimate().modes[m].marginal;
    worst = std::fmax(worst, std::fmax(Distance(marginal[0], series.g[m]), Distance(marginal[1], series.theta2[m])));
  }
  return worst;
}

TEST(FlowEstimator, EveryEffectIsRecoveredWhereTheBaseModelIsBiased) {
  for (const FlowCase& one : FlowCases()) {
    const ValveSeries series = Measured({one}, 4000);
    EstimatorSettings base = Quick(BuiltinSettings("soft_actuator_excited"));
    base.forgetting.drift_share = 0.0;  // else its posterior is wide, as it should be of what does not stay
    Rig with(Quick(WithFlowEffects({one}))), without(base);
    double worst_without = 0.0;
    for (const DataPack& pack : series.Packs()) with.Step(pack);
    FlowCase strong = one;
    strong.truth *= 1.25;
    for (const DataPack& pack : Measured({strong}, 4000).Packs()) {
      without.Step(pack);
      if (pack.seq > 10) worst_without = std::fmax(worst_without, BaseDistance(without, series, one.modes));
    }
    for (const std::size_t m : one.modes) {
      const MarginalSummary& amplitude = with.estimate().modes[m].marginal[3];
      EXPECT_LT(Distance(amplitude, one.truth), 4.0) << one.name << " of valve " << m << ": " << amplitude.ar_ap;
      EXPECT_LT(amplitude.sd, 0.2 * std::fabs(one.truth)) << one.name << " of valve " << m;
    }
    EXPECT_LT(BaseDistance(with, series, {0, 1}), 4.0) << one.name;
    EXPECT_GT(worst_without, 15.0) << one.name;
  }
}

TEST(FlowEstimator, ThreeEffectsAreToldApart) {
  const std::vector<FlowCase> all = FlowCases();
  const std::vector<FlowCase> cases{all[2], all[3], all[4]};
  const ValveSeries series = Measured(cases, 6000);
  Rig rig(Quick(WithFlowEffects(cases)));
  for (const DataPack& pack : series.Packs()) rig.Step(pack);
  for (std::size_t e = 0; e < cases.size(); ++e)
    EXPECT_LT(Distance(rig.estimate().modes[0].marginal[3 + e], cases[e].truth), 4.0) << cases[e].name;
}

TEST(FlowEstimator, IntervalsCoverTheTruthOverSeeds) {
  const FlowCase leak = FlowCases()[4];
  constexpr int kSeeds = 40;
  int covered = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const ValveSeries series = Measured({leak}, 1500, seed);
    Rig rig(Quick(WithFlowEffects({leak})));
    for (const DataPack& pack : series.Packs()) rig.Step(pack);
    const auto& m = rig.estimate().modes[0].marginal;
    const double truth[] = {series.g[0], series.theta2[0], 0.0, leak.truth};
    for (const std::size_t d : {0u, 1u, 3u}) covered += m[d].q025 <= truth[d] && truth[d] <= m[d].q975 ? 1 : 0;
  }
  const double share = covered / (kSeeds * 3.0);
  EXPECT_GT(share, 0.88);
  EXPECT_LT(share, 1.0);
}

/// Largest distance of g, theta2 and the bias of the valve that lets out, with a zero of the pressure sensor, after all
/// packs. The first packs leave a long, thin, bent ridge, which later ones cut at a narrow angle.
double BiasDistance(std::uint64_t sampler_seed, bool estimate_noise, int draws) {
  const FlowCase bias = FlowCases()[0];
  const ValveSeries series = Measured({bias}, 4000);
  EstimatorSettings settings = WithFlowEffects({bias});
  settings.sampler.rule = DrawRule::kFixed;
  settings.sampler.fixed_draws = draws;
  settings.sampler.seed = sampler_seed;
  for (NoiseSettings& noise : settings.noise) noise.estimate_std = estimate_noise;
  Rig rig(settings);
  for (const DataPack& pack : series.Packs()) rig.Step(pack);
  return std::fmax(BaseDistance(rig, series, {1}), Distance(rig.estimate().modes[1].marginal[3], bias.truth));
}

// In some pack drift explains the data better than rest does, by chance, and in the next ones it does not: what rested
// has to be there still.
TEST(FlowEstimator, WhatALaterPackConfirmsWasNotLost) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    EXPECT_LT(BiasDistance(seed, true, 6000), 4.0) << seed;
    EXPECT_LT(BiasDistance(seed, true, 14'979), 4.0) << seed;
  }
}

// The law has a pole: at a bias above all pressures the signs of gain and flow turn round, and a fit that starts at the
// mean of the prior, where the gain is zero, ends there or here.
TEST(FlowEstimator, FindsTheModeThatHasTheMass) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) EXPECT_LT(BiasDistance(seed, false, 6000), 4.0) << seed;
}

// A valve that is told to open less than its dead band lets nothing pass, which a gain of zero would explain, too.
TEST(FlowEstimator, AChamberAtRestDoesNotLookLikeAnotherValve) {
  const FlowCase band = FlowCases()[2];
  Rig rig(Quick(WithFlowEffects({band})));
  const ValveSeries series = Measured({band}, 4000);
  const std::vector<DataPack> packs = series.Packs();
  for (const DataPack& pack : packs) rig.Step(pack);
  const ModeEstimate before = rig.estimate().modes[0];
  std::mt19937_64 generator(4);
  std::normal_distribution<double> noise(0.0, 500.0);
  for (int k = 1; k <= 20; ++k) {
    DataPack rest = packs.back();
    rest.seq = packs.back().seq + k;
    rest.t_last_s += 0.1 * k;
    for (auto& u : rest.u) u = {0.004, 0.0, 101'325.0 + 40e3, noise(generator)};
    rig.Step(rest);
    EXPECT_NE(rig.estimate().modes[0].decision, Decision::kModification) << k;
  }
  const ModeEstimate& after = rig.estimate().modes[0];
  for (const std::size_t d : {0u, 1u, 3u})
    EXPECT_NEAR(after.marginal[d].ar_ap, before.marginal[d].ar_ap, 2.0 * before.marginal[d].sd) << d;
}

/// A method after all packs, told the noise in the unit of what it regresses.
std::unique_ptr<Rig> AfterMeasured(const ValveSeries& series, Method method, bool regress_rate, int pf_updates = 1) {
  EstimatorSettings settings = BuiltinSettings("soft_actuator_excited");
  settings.method = method;
  settings.regress_rate = regress_rate;
  settings.forgetting.threshold = 1e9;  // nothing changes: all data count
  settings.forgetting.lambda_max = 1.0 - 1e-12;
  settings.baseline.recall = true;
  settings.baseline.rls_forgetting = 1.0;
  settings.baseline.pf_updates = pf_updates;
  for (NoiseSettings& noise : settings.noise) noise.std = series.rate_noise * (regress_rate ? 1.0 : 5e-4);
  auto rig = std::make_unique<Rig>(settings);
  for (const DataPack& pack : series.Packs()) rig->Step(pack);
  return rig;
}

// Twenty times the noise of the scenario: as a regressor it would bias the gains by a share of noise^2 / pdot^2.
TEST(FlowEstimator, ThePressureRateIsRegressedWithoutBias) {
  ValveSeries series;
  series.rate_noise = 10e3;
  series.Simulate(10'000);
  const auto rate = AfterMeasured(series, Method::kArmcmc, true);
  const auto flow = AfterMeasured(series, Method::kArmcmc, false);
  EXPECT_LT(BaseDistance(*rate, series, {0, 1}), 3.0);
  EXPECT_EQ(rate->estimator.target_unit(), "Pa/s");
  EXPECT_EQ(flow->estimator.target_unit(), "sqrt(Pa)");
}

// They are told the same noise. Least squares keep the flow's law, which is linear, and weigh by the pressure rate's.
TEST(FlowEstimator, TheBaselinesTakeTheNoiseOfThePressureRate) {
  ValveSeries series;
  series.Simulate(10'000);
  const auto ours = AfterMeasured(series, Method::kArmcmc, true);
  const auto rls = AfterMeasured(series, Method::kRls, true);
  EXPECT_EQ(rls->estimator.target_unit(), "sqrt(Pa)");
  for (std::size_t m = 0; m < 2; ++m)
    for (std::size_t d = 0; d < 2; ++d) {
      const MarginalSummary &a = rls->estimate().modes[m].marginal[d], &b = ours->estimate().modes[m].marginal[d];
      EXPECT_NEAR(a.sd / b.sd, 1.0, 0.15) << "valve " << m << ", parameter " << d;
      EXPECT_NEAR(a.ar_ap, b.ar_ap, 2.0 * b.sd) << "valve " << m << ", parameter " << d;
    }
  for (const int updates : {1, 4}) {
    const auto pf = AfterMeasured(series, Method::kParticleFilter, true, updates);
    for (std::size_t m = 0; m < 2; ++m)
      EXPECT_NEAR(pf->estimate().modes[m].marginal[0].ar_ap / series.g[m], 1.0, 0.15) << updates << " updates a pack";
  }
}

TEST(FlowEstimator, ReportsAmplitudesAfterTheModelsOwnQuantities) {
  const Estimator estimator(WithFlowEffects({FlowCases()[4], FlowCases()[0]}));
  ASSERT_EQ(estimator.num_reported(), 5);
  EXPECT_EQ(estimator.reported(2).name, "theta1");
  EXPECT_EQ(estimator.reported(3).name, "leak_rate");
  EXPECT_EQ(estimator.reported(3).unit, "1/s");
  EXPECT_EQ(estimator.reported(4).name, "pressure_bias_bias");
  EXPECT_EQ(estimator.num_modes(), 2);
}

// The effect is in what the estimator shows, too: shut in, the pressure of a leaking chamber falls, and so does the
// angle that it predicts from the valves alone.
TEST(FlowEstimator, ThePredictedAngleFeelsTheLeak) {
  FlowCase leak = FlowCases()[4];
  leak.truth = 0.5;
  const ValveSeries series = Measured({leak}, 4000);
  Rig with(Quick(WithFlowEffects({leak}))), without(Quick(BuiltinSettings("soft_actuator_excited")));
  const std::vector<DataPack> packs = series.Packs();
  for (const DataPack& pack : packs) {
    with.Step(pack);
    without.Step(pack);
  }
  double angle = 0.0, other = 0.0;
  const double start = packs.back().u[99][2] - 101'325.0;
  for (int k = 1; k <= 10; ++k) {
    DataPack shut = packs.back();
    shut.seq = packs.back().seq + k;
    shut.t_last_s += 0.1 * k;
    for (std::size_t n = 0; n < 100; ++n)
      shut.u[n] = {0.0, 0.0,
                   101'325.0 + start * std::exp(-leak.truth * (0.1 * (k - 1) + 1e-3 * static_cast<double>(n + 1))),
                   0.0};
    const double before = with.estimate().y_free_run, before_other = without.estimate().y_free_run;
    with.Step(shut);
    without.Step(shut);
    if (k > 2) {  // the angle has settled on the pressure
      angle += std::log(with.estimate().y_free_run / before);
      other += std::log(without.estimate().y_free_run / before_other);
    }
  }
  EXPECT_NEAR(angle, -0.8 * leak.truth, 0.05 * leak.truth);
  EXPECT_NEAR(other, 0.0, 0.01);
}

TEST(FlowEstimator, ResetEqualsAFreshEstimatorToTheBit) {
  const std::vector<FlowCase> cases{FlowCases()[1], FlowCases()[4]};
  const std::vector<DataPack> packs = Measured(cases, 1000).Packs();
  const EstimatorSettings settings = Quick(WithFlowEffects(cases));
  Rig used(settings), fresh(settings);
  for (std::size_t k = 0; k < 4; ++k) used.Step(packs[k]);
  used.estimator.Reset();
  for (std::size_t k = 4; k < packs.size(); ++k) test::ExpectSameBits(used.Step(packs[k]), fresh.Step(packs[k]));
}

TEST(FlowEstimator, ARestoredEstimatorGoesOnToTheBit) {
  const FlowCase leak = FlowCases()[4];
  const std::vector<DataPack> packs = Measured({leak}, 2000).Packs();
  const EstimatorSettings settings = Quick(WithFlowEffects({leak}));
  Rig whole(settings), resumed(settings);
  for (std::size_t k = 0; k < 15; ++k) whole.Step(packs[k]);
  std::vector<std::byte> adjusted(Estimator::kSnapshotBytes), executed(Estimator::kSnapshotBytes);
  adjusted.resize(whole.estimator.SaveAdjusted(adjusted));
  executed.resize(whole.estimator.SaveExecuted(executed));
  ASSERT_TRUE(resumed.estimator.Restore(adjusted, executed));
  for (std::size_t k = 16; k < packs.size(); ++k) {  // a lost pack, so that both predict from the measurements
    whole.Step(packs[k]);
    resumed.Step(packs[k]);
    for (std::size_t m = 0; m < 2; ++m)
      for (std::size_t d = 0; d < 4; ++d) {
        EXPECT_EQ(whole.estimate().modes[m].marginal[d].ar_ap, resumed.estimate().modes[m].marginal[d].ar_ap);
        EXPECT_EQ(whole.estimate().modes[m].marginal[d].sd, resumed.estimate().modes[m].marginal[d].sd);
      }
  }
}

// After the eighth pack rest and drift are two densities.
TEST(FlowEstimator, ARestoredEstimatorKnowsWhatRestsAndWhatDrifts) {
  const FlowCase bias = FlowCases()[0];
  const std::vector<DataPack> packs = Measured({bias}, 2000).Packs();
  EstimatorSettings settings = Quick(WithFlowEffects({bias}));
  settings.sampler.seed = 9;
  Rig whole(settings), resumed(settings);
  for (std::size_t k = 0; k < 8; ++k) whole.Step(packs[k]);
  const ModeEstimate& before = whole.estimate().modes[1];
  ASSERT_GT(before.p_drifted, 0.1);
  ASSERT_LT(before.p_drifted, 0.9);
  std::vector<std::byte> adjusted(Estimator::kSnapshotBytes), executed(Estimator::kSnapshotBytes);
  adjusted.resize(whole.estimator.SaveAdjusted(adjusted));
  executed.resize(whole.estimator.SaveExecuted(executed));
  ASSERT_TRUE(resumed.estimator.Restore(adjusted, executed));
  for (std::size_t k = 9; k < packs.size(); ++k) {
    whole.Step(packs[k]);
    resumed.Step(packs[k]);
    for (std::size_t d = 0; d < 4; ++d) {
      EXPECT_EQ(whole.estimate().modes[1].marginal[d].ar_ap, resumed.estimate().modes[1].marginal[d].ar_ap) << k;
      EXPECT_EQ(whole.estimate().modes[1].marginal[d].sd, resumed.estimate().modes[1].marginal[d].sd) << k;
    }
  }
}

TEST(FlowEstimator, StepsDoNotTouchTheHeap) {
  if (!test::AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  const std::vector<DataPack> packs = Measured(FlowCases(), 1000).Packs();
  Rig rig(Quick(WithFlowEffects(FlowCases())));
  const test::AllocCounter guard;
  for (const DataPack& pack : packs) rig.Step(pack);
  DataPack bad = packs.back();
  bad.num_samples = 0;
  rig.Step(bad);
  rig.estimator.Reset();
  rig.Step(packs[0]);
  EXPECT_EQ(guard.count() + guard.frees(), 0);
}

TEST(FlowSettings, SayWhyAnEffectDoesNotRun) {
  const auto problem = [](const std::string& name, EffectGate gate = EffectGate::kAlways) -> std::string {
    EstimatorSettings settings = BuiltinSettings("soft_actuator_excited");
    settings.effects[0] = MakeEffect(SoftActuator::kInfo, name);
    settings.effects[0].gate = gate;
    settings.num_effects = 1;
    try {
      settings.Validate();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  for (const EffectInfo* info : ActuatorEffects::kInfos) {
    const std::string name(info->name);
    if (info->online) {
      EXPECT_EQ(problem(name), "accepted") << name;
      EXPECT_THAT(problem(name, EffectGate::kContact), HasSubstr("an actuator has no contact"));
    } else {
      EXPECT_THAT(problem(name), AllOf(HasSubstr(name + " is for offline fits only"), HasSubstr("bending angle"),
                                       HasSubstr("valve_dead_band")));
    }
  }
  EXPECT_THROW((void)MakeEffect(HuntCrossley::kInfo, "leak"), std::invalid_argument) << "of the contact plant";
}

// A new effect of the flow is one header and one entry.
TEST(FlowSettings, TheFlowsEffectsAreTheOnlineOnesOfTheActuator) {
  std::vector<std::string_view> online, flow;
  for (const EffectInfo* info : ActuatorEffects::kInfos)
    if (info->online) online.push_back(info->name);
  for (const EffectInfo* info : FlowEffects::kInfos) flow.push_back(info->name);
  EXPECT_EQ(online, flow);
}

}  // namespace
}  // namespace armcmc::flow_estimator_test
