// The log-likelihood of laws that are linear in all parameters but one at most, against that of every sample.

#include "armcmc/quadratic_score.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/estimator_rig.hpp"
#include "core/kernel_sets.hpp"
#include "core/plant/described_packs.hpp"
#include "core/plant/plants.hpp"
#include "core/same_posteriors.hpp"
#include "core/sample_scores.hpp"

namespace armcmc::quadratic_score_test {
namespace {

const LinearPart kContactPart = HuntCrossley::kInfo.linear[0];

/// Samples of the contact, and candidates about some place.
struct ContactCase {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  NoiseModel noise;
  ParameterSpace space;
  ModeData data;
  std::vector<std::vector<double>> rows;
  std::vector<const double*> u;
  Gaussian about;  ///< Where the posterior lies.

  /// @param spread  Of the candidates, in prior standard deviations.
  ContactCase(double noise_std, bool estimate_std, bool weighted, double spread) {
    settings.noise[0].std = noise_std;
    settings.noise[0].estimate_std = estimate_std;
    noise = NoiseModel(settings.noise[0]);
    space = ParameterSpace(settings, settings.noise[0]);
    test::Contact contact;
    contact.noise_std = noise_std;
    HuntCrossley::Prepare(contact.Pack(20), {}, 0, &data);
    data.weighted = weighted;
    for (int n = 0; n < data.num_samples; ++n)
      data.weight[static_cast<std::size_t>(n)] = weighted ? std::exp(-0.01 * (data.num_samples - n)) : 1.0;
    const double truth[] = {(4.0 - 2.5) / 2.0, (2.3 - 2.5) / 2.0, (1.7 - 1.5) / 0.35, 0.0};
    about = {ParamVector::Zero(space.dim), ParamMatrix::Identity(space.dim, space.dim) * 1e4};
    std::mt19937_64 g(3);
    std::normal_distribution<double> normal;
    for (int d = 0; d < space.dim; ++d) {
      const auto i = static_cast<std::size_t>(d);
      about.mean[d] = truth[i];
      rows.emplace_back();
      for (int l = 0; l < kTileLanes; ++l)
        rows[i].push_back(std::clamp(truth[i] + spread * normal(g), space.lower[i], space.upper[i]));
      u.push_back(rows[i].data());
    }
    for (const auto& row : rows) u.push_back(row.data());
  }

  /// The same candidates, sample by sample.
  [[nodiscard]] std::vector<double> Exactly(const simd::Kernels& kernels) const {
    return test::ScoreEverySample(kernels, 0, space, noise, data, u.data());
  }
};

TEST(QuadraticScore, IsTheLogLikelihoodOfEverySample) {
  QuadraticScratch scratch(2);
  for (const bool estimate_std : {false, true})
    for (const bool weighted : {false, true})
      for (const double spread : {0.01, 0.1, 1.0}) {
        const ContactCase c(0.1, estimate_std, weighted, spread);
        for (const simd::Kernels* kernels : test::RunnableKernels()) {
          QuadraticScore score(*kernels, 0, c.space, c.noise, kContactPart);
          score.Prepare(c.data, c.about, &scratch);
          ASSERT_TRUE(score.ready()) << kernels->name;
          std::vector<double> out(kTileLanes);
          score.Score(c.u.data(), 0, out.data());
          const std::vector<double> expected = c.Exactly(*kernels);
          for (std::size_t l = 0; l < kTileLanes; ++l) {
            // The bound is that of the noise at `about`: errors count for more where a candidate believes in less.
            const double precision = estimate_std ? std::exp(-2.0 * c.space.scale[3] * c.rows[3][l]) : 1.0;
            EXPECT_NEAR(out[l], expected[l], QuadraticScore::kTolerance * std::fmax(precision, 1.0))
                << kernels->name << ", noise " << estimate_std << ", weights " << weighted << ", spread " << spread;
          }
        }
      }
}

TEST(QuadraticScore, HasTheLeversOfADriftFactor) {
  QuadraticScratch scratch(2);
  const auto factor = std::make_unique<DriftFactor>();
  factor->dim = 3;
  for (int d = 0; d < 3; ++d)
    for (int n = 0; n < kMaxPackSamples; ++n) factor->lever[d][n] = std::sin(0.1 * n + d) * (1.0 + d);
  for (const bool estimate_std : {false, true})
    for (const double spread : {0.01, 0.3}) {
      const ContactCase c(0.1, estimate_std, true, spread);
      for (const simd::Kernels* kernels : test::RunnableKernels()) {
        QuadraticScore score(*kernels, 0, c.space, c.noise, kContactPart);
        score.Prepare(c.data, c.about, &scratch, factor.get());
        ASSERT_TRUE(score.ready()) << kernels->name;
        const auto theta = std::make_unique<ThetaTile>();
        const auto tile = std::make_unique<PredictionTile>();
        alignas(64) std::array<double, kTileLanes> log_scale;
        kernels->to_physical(c.space, c.u.data(), 0, theta.get(), log_scale.data());
        kernels->predict(0, c.data, *theta, tile.get());
        LeverTile expected, levers;
        alignas(64) std::array<double, kTileLanes> log_likelihood;
        kernels->lever_sums(*factor, c.noise, c.data, *tile, log_scale.data(), &expected, log_likelihood.data());
        score.Levers(c.u.data(), 0, &levers);
        for (int d = 0; d < 3; ++d)
          for (int l = 0; l < kTileLanes; ++l)
            EXPECT_NEAR(levers.value[d][l], expected.value[d][l], 1e-6 * (1.0 + std::fabs(expected.value[d][l])))
                << kernels->name << ", lever " << d << ", lane " << l;
      }
    }
}

TEST(QuadraticScore, FusedInstructionSetsGiveTheSameBits) {
  const auto sets = test::FusedKernels();
  if (sets.size() < 2) GTEST_SKIP() << "this CPU runs one fused instruction set only";
  const ContactCase c(0.1, true, true, 0.3);
  QuadraticScratch scratch(2);
  std::vector<std::vector<double>> out;
  for (const simd::Kernels* kernels : sets) {
    QuadraticScore score(*kernels, 0, c.space, c.noise, kContactPart);
    score.Prepare(c.data, c.about, &scratch);
    ASSERT_TRUE(score.ready());
    score.Score(c.u.data(), 0, out.emplace_back(kTileLanes).data());
  }
  EXPECT_EQ(out[0], out[1]);
}

TEST(QuadraticScore, IsNotReadyWhereItCannotBeExact) {
  QuadraticScratch scratch(2);
  {
    // 10 N and more at a noise of a micronewton: sums of squares do not have the digits.
    const ContactCase c(1e-6, false, false, 0.1);
    QuadraticScore score(simd::Best(), 0, c.space, c.noise, kContactPart);
    score.Prepare(c.data, c.about, &scratch);
    EXPECT_FALSE(score.ready());
  }
  ContactCase c(0.1, false, false, 0.1);
  QuadraticScore score(simd::Best(), 0, c.space, c.noise, kContactPart);
  score.Prepare(c.data, c.about, &scratch);
  EXPECT_TRUE(score.ready());
  c.data.target[7] = std::nan("");
  score.Prepare(c.data, c.about, &scratch);
  EXPECT_FALSE(score.ready());
  c.settings.noise[0].kind = NoiseKind::kStudentT;
  const NoiseModel student(c.settings.noise[0]);
  EXPECT_FALSE(QuadraticScore(simd::Best(), 0, c.space, student, kContactPart).applies());
  EXPECT_FALSE(QuadraticScore(simd::Best(), 0, c.space, c.noise, {}).applies());
}

TEST(QuadraticScore, GivesTheSamePosterior) {
  const test::Contact contact;
  std::vector<DataPack> packs;
  for (std::int64_t seq = 1; seq <= 12; ++seq) packs.push_back(contact.Pack(seq));
  test::ExpectSamePosteriors(BuiltinSettings("hunt_crossley"), packs);
}

TEST(QuadraticScore, GivesTheSamePosteriorInEveryMode) {
  // A noise of 0.1 beside what the law changes by within a prior standard deviation, some thousands. The parameters are
  // hardly correlated: the last digits decide which way an axis of the proposal points, and so which draws are made.
  const test::Actuator actuator;
  std::vector<DataPack> packs;
  for (std::int64_t seq = 1; seq <= 12; ++seq) packs.push_back(actuator.Pack(seq, 60));
  test::ExpectSamePosteriors(test::ActuatorSettings(), packs, 0.02);
}

TEST(QuadraticScore, GivesTheSamePosteriorBesideAddedEffects) {
  EstimatorSettings settings = BuiltinSettings("hunt_crossley");
  const ModelInfo& info = HuntCrossley::kInfo;
  settings.effects[0] = MakeEffect(info, "coulomb_friction");
  settings.num_effects = 1;
  const test::Contact contact;
  std::vector<DataPack> packs;
  for (std::int64_t seq = 1; seq <= 8; ++seq) packs.push_back(contact.Pack(seq));
  test::ExpectSamePosteriors(settings, packs);
}

std::vector<DataPack> AxisPacks(const PlantProgram& plant, double (*law)(double v, double a)) {
  test::GaussianNoise noise(1.0);
  std::vector<DataPack> packs;
  for (std::int64_t seq = 1; seq <= 8; ++seq)
    packs.push_back(test::DescribedPack(plant, seq, [&](double t) {
      test::PlantSample s;
      s.u[0] = 0.1 * std::sin(7.0 * t) + 0.05 * std::sin(31.0 * t);
      s.u[1] = 0.7 * std::cos(7.0 * t) + 1.55 * std::cos(31.0 * t);
      s.y = law(s.u[0], s.u[1]) + noise();
      return s;
    }));
  return packs;
}

TEST(QuadraticScore, ServesDescribedLaws) {
  const auto linear = test::Program(test::DescribedAxis());
  EXPECT_EQ(linear->info().linear[0].num_linear, 3);
  EXPECT_EQ(linear->info().linear[0].curved, -1);
  test::ExpectSamePosteriors(DescribedSettings(linear),
                             AxisPacks(*linear, [](double v, double a) { return 95.0 * a + 210.0 * v - 3.0; }));
  PlantDescription description = test::DescribedAxis();
  description.law = "M*a + Fv*tanh(v/vs) + off";
  description.parameters[1].unit = "N";
  description.parameters.push_back({"vs", "m/s", "normal", 0.05, 0.02, 0.02, 0.2});
  const auto curved = test::Program(description);
  EXPECT_EQ(curved->info().linear[0].num_linear, 3);
  EXPECT_EQ(curved->info().linear[0].curved, 3);
  test::ExpectSamePosteriors(DescribedSettings(curved), AxisPacks(*curved, [](double v, double a) {
                               return 95.0 * a + 210.0 * std::tanh(v / 0.06) - 3.0;
                             }));
}

TEST(QuadraticScore, SeesALawThatBendsBetweenThePoints) {
  // A dip of the exponent's own, narrower than the points are apart, where the posterior lies: at none of them it
  // shows.
  PlantDescription description = test::DescribedContact();
  description.modes[0].law = "x^p * (K + B*v) * (1 - 0.5*exp(-((p - 1.7)/1e-4)^2))";
  const auto plant = test::Program(description);
  ASSERT_EQ(plant->info().linear[0].curved, 2);
  const ContactCase c(0.1, false, false, 0.1);
  const DataPack pack = test::DescribedPack(*plant, 1, [](double t) {
    return test::PlantSample{{0.3 + 0.2 * std::sin(20.0 * t), 4.0 * std::cos(20.0 * t)}, 1.0};
  });
  PlantPack prepared;
  expression::FeatureMemory memory;
  memory.Clear();
  ASSERT_TRUE(plant->Prepare(pack, &memory, nullptr, &prepared));
  auto data = std::make_unique<ModeData>();
  plant->Fill(prepared, pack.num_samples, 0, data.get());
  data->weight.fill(1.0);
  data->weighted = false;
  QuadraticScratch scratch(2);
  QuadraticScore score(simd::Best(), -1, c.space, c.noise, plant->info().linear[0]);
  score.Prepare(*data, c.about, &scratch);
  EXPECT_FALSE(score.ready());
  Gaussian elsewhere = c.about;
  elsewhere.mean[2] -= 1.0;
  score.Prepare(*data, elsewhere, &scratch);
  EXPECT_TRUE(score.ready()) << "nobody comes to the dip";
}

TEST(QuadraticScore, LeavesAloneWhatBendsTooMuch) {
  // A corner for every sample, where the parameter passes its speed: no series settles, and every bit is that of the
  // samples.
  PlantDescription description = test::DescribedAxis();
  description.law = "M*a + Fv*max(v, vs) + off";
  description.parameters.push_back({"vs", "m/s", "normal", 0.0, 0.1, -0.2, 0.2});
  const auto plant = test::Program(description);
  ASSERT_EQ(plant->info().linear[0].curved, 3);
  EstimatorSettings settings = DescribedSettings(plant);
  test::Rig tried(settings);
  settings.sampler.use_linearity = false;
  test::Rig samples(settings);
  for (const DataPack& pack : AxisPacks(*plant, [](double v, double a) { return 95.0 * a + 210.0 * v - 3.0; })) {
    const Estimate& a = tried.Step(pack);
    test::ExpectSameBits(a, samples.Step(pack));
  }
}

}  // namespace
}  // namespace armcmc::quadratic_score_test
