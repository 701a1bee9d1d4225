#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "plants/soft_actuator/model.hpp"
#include "support/alloc_counter.hpp"
#include "support/packs.hpp"

namespace armcmc::baselines_test {
namespace {

EstimatorSettings SettingsOf(Method method) {
  EstimatorSettings s = BuiltinSettings("hunt_crossley");
  s.method = method;
  s.sampler.rule = DrawRule::kFixed;
  s.sampler.fixed_draws = 4000;
  s.baseline.pf_jitter = 0.005;
  return s;
}

/// A contact that is well excited: 0.5 .. 1.5 m at 4 Hz.
DataPack Pack(int seq, test::Normal* normal, const test::ContactTruth& truth = {}, double hertz = 4.0) {
  return test::MakeContactPack(seq, {.depth = 1.0, .swing = 0.5, .hertz = hertz, .phase = 0.0}, truth, 0.1, normal);
}

class Baseline : public ::testing::TestWithParam<Method> {};

TEST_P(Baseline, DoesNotAllocateInAStep) {
  Estimator estimator(SettingsOf(GetParam()));
  const auto result = estimator.MakeResult();
  const auto estimate = std::make_unique<Estimate>();
  test::Normal normal(1);
  const DataPack first = Pack(1, &normal), second = Pack(2, &normal);
  estimator.Adjust(first, 0, {}, result.get());
  estimator.Execute(*result, estimate.get());
  long count = -1;
  {
    const test::AllocCounter guard;
    estimator.Adjust(second, 0, {}, result.get());
    estimator.Execute(*result, estimate.get());
    count = guard.count();
  }
  if (!test::AllocCounter::kActive) GTEST_SKIP() << test::kAllocCounterInactive;
  EXPECT_EQ(count, 0);
}

TEST_P(Baseline, RepeatsToTheBitAndAfterAReset) {
  Estimator estimator(SettingsOf(GetParam()));
  const auto result = estimator.MakeResult();
  const auto estimate = std::make_unique<Estimate>();
  double runs[2] = {};
  for (double& run : runs) {
    test::Normal normal(2);
    for (int k = 1; k <= 4; ++k) {
      estimator.Adjust(Pack(k, &normal), 0, {}, result.get());
      estimator.Execute(*result, estimate.get());
    }
    run = estimate->modes[0].marginal[0].ar_map;
    estimator.Reset();
  }
  EXPECT_EQ(runs[0], runs[1]);
  EXPECT_GT(runs[0], 0.0);
}

INSTANTIATE_TEST_SUITE_P(All, Baseline, ::testing::Values(Method::kRls, Method::kParticleFilter, Method::kMetropolis),
                         [](const auto& m) {
                           return std::string(m.param == Method::kRls              ? "Rls"
                                              : m.param == Method::kParticleFilter ? "ParticleFilter"
                                                                                   : "Metropolis");
                         });

/// Mean and sd of K after some packs of a well excited contact.
MarginalSummary StiffnessAfter(const EstimatorSettings& settings, int packs) {
  Estimator estimator(settings);
  const auto result = estimator.MakeResult();
  const auto estimate = std::make_unique<Estimate>();
  test::Normal normal(4);
  for (int k = 1; k <= packs; ++k) {
    estimator.Adjust(Pack(k, &normal), 0, {}, result.get());
    estimator.Execute(*result, estimate.get());
  }
  return estimate->modes[0].marginal[0];
}

TEST(Metropolis, AgreesWithArmcmcOnOnePack) {
  // The first pack: both sample likelihood x P_0.
  const MarginalSummary plain = StiffnessAfter(SettingsOf(Method::kMetropolis), 1);
  EstimatorSettings settings = SettingsOf(Method::kArmcmc);
  settings.sampler.fixed_draws = 14'979;
  const MarginalSummary reference = StiffnessAfter(settings, 1);
  // 2000 correlated draws have an effective size of about 150: five standard errors of the mean.
  EXPECT_NEAR(plain.ar_ap, reference.ar_ap, 0.4 * reference.sd);
  EXPECT_NEAR(plain.sd, reference.sd, 0.25 * reference.sd);
}

TEST(ParticleFilter, AgreesWithArmcmcOnManyPacks) {
  EstimatorSettings settings = SettingsOf(Method::kParticleFilter);
  settings.baseline.pf_jitter = 0.0;
  const MarginalSummary particles = StiffnessAfter(settings, 8);
  const MarginalSummary reference = StiffnessAfter(SettingsOf(Method::kArmcmc), 8);
  EXPECT_NEAR(particles.ar_ap, reference.ar_ap, 1.5 * reference.sd);
  EXPECT_LT(particles.sd, 2.0 * reference.sd);
  EXPECT_GT(particles.sd, 0.5 * reference.sd);
}

TEST(Rls, FindsTheContactWhereItsLinearisationHolds) {
  // At 0.05 Hz (B / K) v stays below 0.09: what the logarithm drops is a few per mille.
  Estimator estimator(SettingsOf(Method::kRls));
  const auto result = estimator.MakeResult();
  const auto estimate = std::make_unique<Estimate>();
  test::Normal normal(5);
  for (int k = 1; k <= 400; ++k) {
    estimator.Adjust(Pack(k, &normal, {}, 0.05), 0, {}, result.get());
    estimator.Execute(*result, estimate.get());
  }
  EXPECT_NEAR(estimate->modes[0].marginal[0].ar_map, 4.0, 0.1);
  EXPECT_NEAR(estimate->modes[0].marginal[2].ar_map, 1.7, 0.06);
}

DataPack ValvePack(int seq, int mode, double gain) {
  DataPack pack = test::BlankPack(SoftActuator::kInfo.plant, seq);
  for (std::size_t n = 0; n < 100; ++n) {
    const double p = 101'325.0 + 1.0 + 0.01 * static_cast<double>(n), pdot = 10.0;
    const double head = mode == 0 ? std::sqrt(800e3 - p) : std::sqrt(p - 101'325.0);
    pack.u[n] = {0.0, 0.0, p, pdot};
    pack.u[n][static_cast<std::size_t>(mode)] = gain * pdot / head;
  }
  return pack;
}

TEST(Rls, HasOneVectorForBothValvesUnlessItRecalls) {
  for (const bool recall : {false, true}) {
    EstimatorSettings settings = BuiltinSettings("soft_actuator");
    settings.method = Method::kRls;
    settings.baseline.recall = recall;
    Estimator estimator(settings);
    const auto result = estimator.MakeResult();
    const auto estimate = std::make_unique<Estimate>();
    for (int k = 1; k <= 4; ++k) {
      const int mode = k <= 2 ? 0 : 1;
      estimator.Adjust(ValvePack(k, mode, mode == 0 ? 4e-4 : -3e-4), 0, {}, result.get());
      estimator.Execute(*result, estimate.get());
    }
    EXPECT_NEAR(estimate->modes[1].marginal[0].ar_map, -3e-4, 1e-6);
    EXPECT_NEAR(estimate->modes[0].marginal[0].ar_map, recall ? 4e-4 : -3e-4, 1e-6) << "recall " << recall;
  }
}

}  // namespace
}  // namespace armcmc::baselines_test
