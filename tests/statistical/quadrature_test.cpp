#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "armcmc/adjust_result.hpp"
#include "armcmc/estimator.hpp"
#include "armcmc/mode_sampler.hpp"
#include "armcmc/summary.hpp"
#include "armcmc/transition.hpp"
#include "plants/hunt_crossley/model.hpp"
#include "simd/kernels.hpp"
#include "statistical/quadrature.hpp"
#include "support/packs.hpp"

namespace armcmc::quadrature_test {
namespace {

using test::ContactQuadrature;
using test::ContactTruth;
using test::MakeContactPack;
using test::MarginalTruth;
using test::Motion;
using test::Normal;

constexpr int kPacks = 16;  // whose motions begin 0.4 rad apart: once round
constexpr double kTurn = 0.4;

/// Root mean squares over packs and parameters of the sampler's error against quadrature.
struct Agreement {
  double mean = 0.0, sd = 0.0, quantile = 0.0;
  int terms = 0;
  void Add(const MarginalSummary& m, const MarginalTruth& truth) {
    mean += std::pow((m.ar_ap - truth.mean) / truth.sd, 2);
    sd += std::pow(m.sd / truth.sd - 1.0, 2);
    quantile += 0.5 * (std::pow((m.q025 - truth.q025) / truth.sd, 2) + std::pow((m.q975 - truth.q975) / truth.sd, 2));
    ++terms;
  }
  void Check(double factor) const {
    ::testing::Test::RecordProperty("mean_sd", std::to_string(std::sqrt(mean / terms)));
    ::testing::Test::RecordProperty("sd_relative", std::to_string(std::sqrt(sd / terms)));
    ::testing::Test::RecordProperty("quantile_sd", std::to_string(std::sqrt(quantile / terms)));
    EXPECT_LT(std::sqrt(mean / terms), 0.03 * factor);
    EXPECT_LT(std::sqrt(sd / terms), 0.03 * factor);
    EXPECT_LT(std::sqrt(quantile / terms), 0.1 * factor);
  }
};

double LogInitialPrior(const EstimatorSettings& s, double k, double b, double p) {
  const std::array<double, 3> theta{k, b, p};
  double sum = 0.0;
  for (std::size_t d = 0; d < 3; ++d) {
    const ParameterSettings& q = s.parameters[d];
    if (theta[d] < q.lower || theta[d] > q.upper) return -HUGE_VAL;
    sum -= 0.5 * std::pow((theta[d] - q.mean) / q.sd, 2);
  }
  return sum;
}

/// First packs of a contact: the prior is P_0.
Agreement ColdPacks(const Motion& base, std::uint64_t seed) {
  const EstimatorSettings s = BuiltinSettings("hunt_crossley");
  Normal normal(seed);
  Agreement agreement;
  for (int i = 0; i < kPacks; ++i) {
    EstimatorSettings settings = s;
    settings.sampler.seed = seed + static_cast<std::uint64_t>(i);
    Estimator estimator(settings);
    const auto result = estimator.MakeResult();
    Motion motion = base;
    motion.phase += kTurn * i;
    const DataPack pack = MakeContactPack(1, motion, {}, s.noise[0].std, &normal);
    estimator.Adjust(pack, 0, {}, result.get());
    Estimate e;
    estimator.Execute(*result, &e);
    const MarginalSummary& p = e.modes[0].marginal[2];
    const auto truth = ContactQuadrature::Run(
        pack, s.noise[0].std, [&](double k, double b, double pp) { return LogInitialPrior(s, k, b, pp); },
        std::fmax(1.0, p.ar_ap - 7.0 * p.sd), std::fmin(2.5, p.ar_ap + 7.0 * p.sd), {2.5, 2.5}, {0.25, 0.0, 0.25});
    for (std::size_t d = 0; d < 3; ++d) agreement.Add(e.modes[0].marginal[d], truth[d]);
  }
  return agreement;
}

TEST(Quadrature, AgreesOnFirstPacksWithGoodExcitation) { ColdPacks({1.0, 0.5, 10.0, 0.0}, 21).Check(1.0); }

TEST(Quadrature, AgreesOnFirstPacksWithPoorExcitation) {
  // The paper's own motion moves a tenth of a radian in a pack: a long, bent ridge of (K, B, p).
  ColdPacks({1.2, 1.0, 0.16, 0.0}, 22).Check(2.0);
}

/// Share of a memory's mass that lies inside the bounds of the parameters.
double MassInside(const PosteriorMemory& memory, const ParameterSpace& space, Normal* normal) {
  constexpr int kDraws = 20'000;
  int inside = 0;
  for (int k = 0; k < kDraws; ++k) {
    std::array<double, 3> uniforms{}, u{};
    for (double& v : uniforms) v = std::clamp(0.5 * std::erfc(-(*normal)() / std::sqrt(2.0)), 1e-12, 1.0 - 1e-12);
    const bool first = memory.num_blocks == 1 || k < kDraws * memory.weight[0];
    memory.block[first ? 0 : 1].Draw(uniforms.data(), u.data());
    bool all = true;
    for (std::size_t d = 0; d < 3; ++d) all = all && u[d] >= space.lower[d] && u[d] <= space.upper[d];
    inside += all ? 1 : 0;
  }
  return static_cast<double>(inside) / kDraws;
}

/// Packs that meet the memory of an earlier pack: the target is likelihood x (share memory + (1 - share) P_0), with
/// the memory's density as the sampler holds it. After a modification the memory is that of a change in part, which a
/// Transition of this test chooses again.
Agreement WarmPacks(const ContactTruth& after, std::uint64_t seed, int packs, int* modifications) {
  const EstimatorSettings s = BuiltinSettings("hunt_crossley");
  const NoiseSettings& noise = s.noise[0];
  const ParameterSpace space(s, noise);
  const int capacity = s.sampler.max_draws;
  SamplerWorkspace workspace(3, capacity);
  SummaryWorkspace summary(capacity);
  Normal normal(seed);
  Agreement agreement;
  for (int i = 0; i < packs; ++i) {
    SamplerSettings sampler_settings = s.sampler;
    sampler_settings.seed = seed + static_cast<std::uint64_t>(i);
    ModeSampler sampler(simd::Best(), 0, sampler_settings, s.forgetting, space, NoiseModel(noise));
    PosteriorMemory none, first, second;
    AdjustResult result(1, 3, capacity);
    ModeDraws& draws = result.modes[0];
    const Motion motion{1.0, 0.5, 5.0, kTurn * i};
    const auto run = [&](const DataPack& pack, const PosteriorMemory& previous, PosteriorMemory* next) {
      ModeData data;
      HuntCrossley::Prepare(pack, s.constants, 0, &data);
      data.weight.fill(1.0);
      constexpr Nanos kNever = std::numeric_limits<Nanos>::max() / 2;
      const Status status = sampler.Run(data, previous, static_cast<std::uint64_t>(pack.seq), 0, kNever, {}, kMaxDraws,
                                        &workspace, &draws);
      sampler.Remember({}, &workspace, next, &draws);
      return status;
    };
    const MarginalTable normal_table = MarginalTable::Normal();
    const NoiseModel noise_model(noise);
    Transition transition(simd::Best(), 0, space, noise_model, &normal_table, true);
    EXPECT_EQ(run(MakeContactPack(1, motion, {}, noise.std, &normal), none, &first), Status::kOk);
    transition.Accept(first, draws.decision);
    const DataPack pack = MakeContactPack(2, motion, after, noise.std, &normal);
    EXPECT_EQ(run(pack, first, &second), Status::kOk);
    *modifications += draws.decision == Decision::kModification ? 1 : 0;
    ModeData met;
    HuntCrossley::Prepare(pack, s.constants, 0, &met);
    met.weight.fill(1.0);
    Mismatch mismatch;
    mismatch.decision = draws.decision;
    mismatch.lambda = draws.lambda;
    double share = 0.0;
    const PosteriorMemory& memory = transition.Choose(met, first, &mismatch, &share, &workspace.laplace);
    const double inside = MassInside(memory, space, &normal);
    ModeEstimate estimate;
    Summarise(HuntCrossley::kInfo, s.constants, space, draws, &summary, &estimate);
    const MarginalSummary& p = estimate.marginal[2];
    const auto log_prior = [&](double k, double b, double pp) {
      const std::array<double, 3> theta{k, b, pp};
      std::array<double, 3> u{};
      double fresh = space.norm;
      for (std::size_t d = 0; d < 3; ++d) {
        u[d] = (theta[d] - space.offset[d]) / space.scale[d];
        if (u[d] < space.lower[d] || u[d] > space.upper[d]) return -HUGE_VAL;
        fresh *= std::exp(-0.5 * u[d] * u[d]);
      }
      double density = (1.0 - share) * fresh;
      for (int m = 0; m < memory.num_blocks; ++m)
        density += share / inside * memory.weight[static_cast<std::size_t>(m)] *
                   memory.block[static_cast<std::size_t>(m)].Density(u.data());
      return density > 0.0 ? std::log(density) : -HUGE_VAL;
    };
    const auto truth = ContactQuadrature::Run(pack, noise.std, log_prior, std::fmax(1.0, p.ar_ap - 7.0 * p.sd),
                                              std::fmin(2.5, p.ar_ap + 7.0 * p.sd), {2.5, 2.5}, {0.25, 0.0, 0.25});
    for (std::size_t d = 0; d < 3; ++d) agreement.Add(estimate.marginal[d], truth[d]);
  }
  return agreement;
}

TEST(Quadrature, AgreesOnSecondPacksWhenNothingChanged) {
  int modifications = 0;
  WarmPacks({}, 23, kPacks, &modifications).Check(1.0);
  EXPECT_EQ(modifications, 0);
}

TEST(Quadrature, AgreesAfterAnAbruptChange) {
  int modifications = 0;
  WarmPacks({2.0, 2.3, 1.7}, 24, kPacks, &modifications).Check(1.0);
  EXPECT_EQ(modifications, kPacks);
}

TEST(Quadrature, AgreesWhenAChangeIsTooSmallForAModification) {
  // The memory and the initial prior both have a say: the posterior may have two parts.
  int modifications = 0;
  constexpr int kChanges = 24;
  WarmPacks({3.95, 2.3, 1.7}, 25, kChanges, &modifications).Check(1.0);
  EXPECT_LT(modifications, kChanges / 4);
}

}  // namespace
}  // namespace armcmc::quadrature_test
