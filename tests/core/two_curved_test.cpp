// The log-likelihood of laws that are linear in all parameters but two, against that of every sample.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "armcmc/quadratic_score.hpp"
#include "core/kernel_sets.hpp"
#include "core/plant/described_packs.hpp"
#include "core/plant/plants.hpp"
#include "core/same_posteriors.hpp"
#include "core/sample_scores.hpp"

namespace armcmc::two_curved_test {
namespace {

/// A spring and a damper that each stiffen with an exponent of their own. Nothing has a unit.
PlantDescription TwoPowers(const std::string& law = "K*x^p + B*v*x^q + c") {
  PlantDescription description = test::DescribedContact();
  description.modes[0].law = law;
  description.parameters.push_back({"c", "1", "normal", 0.0, 0.5, -2.0, 2.0});
  description.parameters.push_back({"q", "1", "normal", 1.5, 0.35, 1.0, 2.5});
  for (auto& signal : description.signals) signal.unit = "1", signal.derivative_of = "";
  for (auto& parameter : description.parameters) parameter.unit = "1";
  return description;
}

DataPack PackOf(const PlantProgram& plant, std::int64_t seq, test::GaussianNoise* noise, double q = 1.4) {
  return test::DescribedPack(plant, seq, [&](double t) {
    const double x = 0.25 + 0.15 * std::sin(17.0 * t) + 0.05 * std::sin(45.0 * t);
    const double v = 2.55 * std::cos(17.0 * t) + 2.25 * std::cos(45.0 * t);
    return test::PlantSample{{x, v}, 4.0 * std::pow(x, 1.7) + 2.3 * v * std::pow(x, q) + 0.2 + (*noise)()};
  });
}

/// One pack of TwoPowers(), and candidates about what made it.
struct TwoPowersCase {
  std::shared_ptr<const PlantProgram> plant;
  NoiseModel noise;
  ParameterSpace space;
  PlantPack prepared;
  std::unique_ptr<ModeData> data = std::make_unique<ModeData>();
  std::vector<std::vector<double>> rows;
  std::vector<const double*> u;
  Gaussian about;
  QuadraticScratch scratch{kMaxParams};

  TwoPowersCase(const PlantDescription& description, double noise_std, bool weighted, double spread)
      : plant(test::Program(description)) {
    EstimatorSettings settings = DescribedSettings(plant);
    settings.noise[0].std = noise_std;
    noise = NoiseModel(settings.noise[0]);
    space = ParameterSpace(settings, settings.noise[0]);
    test::GaussianNoise error(noise_std);
    const DataPack pack = PackOf(*plant, 3, &error);
    expression::FeatureMemory memory;
    memory.Clear();
    EXPECT_TRUE(plant->Prepare(pack, &memory, nullptr, &prepared));
    plant->Fill(prepared, pack.num_samples, 0, data.get());
    data->weighted = weighted;
    for (int n = 0; n < data->num_samples; ++n)
      data->weight[static_cast<std::size_t>(n)] = weighted ? std::exp(-0.01 * (data->num_samples - n)) : 1.0;
    const double truth[] = {4.0, 2.3, 1.7, 0.2, 1.4};
    about = {ParamVector::Zero(space.dim), ParamMatrix::Identity(space.dim, space.dim) * 1e4};
    std::mt19937_64 g(3);
    std::normal_distribution<double> normal;
    for (int d = 0; d < space.dim; ++d) {
      const auto i = static_cast<std::size_t>(d);
      about.mean[d] = (truth[i] - space.offset[i]) / space.scale[i];
      rows.emplace_back();
      for (int l = 0; l < kTileLanes; ++l)
        rows[i].push_back(std::clamp(about.mean[d] + spread * normal(g), space.lower[i], space.upper[i]));
    }
    for (const auto& row : rows) u.push_back(row.data());
  }
  [[nodiscard]] QuadraticScore Score(const simd::Kernels& kernels) {
    QuadraticScore score(kernels, -1, space, noise, plant->info().linear[0]);
    score.Prepare(*data, about, &scratch);
    return score;
  }
  [[nodiscard]] std::vector<double> Exactly(const simd::Kernels& kernels) const {
    return test::ScoreEverySample(kernels, -1, space, noise, *data, u.data());
  }
};

TEST(TwoCurvedParameters, ScoreAsEverySampleDoes) {
  // In the third law a function of the second exponent precedes one of the first, and their product tells which is
  // which; in the last one f_0 is curved, and meets what is curved otherwise.
  for (const char* law :
       {"K*x^p + B*v*x^q + c", "K*v*x^q + B*x^p + c", "K*v*exp(q*x) + B*x^p + c", "0.1*exp(p*x) + K*x + B*v*x^q + c*v"})
    for (const bool weighted : {false, true})
      for (const double spread : {0.01, 0.1, 1.0}) {
        TwoPowersCase c(TwoPowers(law), 0.1, weighted, spread);
        ASSERT_EQ(c.plant->info().linear[0].num_linear, 3);
        ASSERT_EQ(c.plant->info().linear[0].second, 4);
        for (const simd::Kernels* kernels : test::RunnableKernels()) {
          const QuadraticScore score = c.Score(*kernels);
          ASSERT_TRUE(score.ready()) << kernels->name;
          std::vector<double> out(kTileLanes);
          score.Score(c.u.data(), 0, out.data());
          const std::vector<double> expected = c.Exactly(*kernels);
          for (std::size_t l = 0; l < kTileLanes; ++l)
            EXPECT_NEAR(out[l], expected[l], QuadraticScore::kTolerance)
                << kernels->name << ' ' << law << ", weights " << weighted << ", spread " << spread;
        }
      }
}

TEST(TwoCurvedParameters, FusedInstructionSetsGiveTheSameBits) {
  const auto sets = test::FusedKernels();
  if (sets.size() < 2) GTEST_SKIP() << "this CPU runs one fused instruction set only";
  TwoPowersCase c(TwoPowers(), 0.1, true, 0.3);
  std::vector<std::vector<double>> out;
  for (const simd::Kernels* kernels : sets) {
    const QuadraticScore score = c.Score(*kernels);
    ASSERT_TRUE(score.ready());
    score.Score(c.u.data(), 0, out.emplace_back(kTileLanes).data());
  }
  EXPECT_EQ(out[0], out[1]);
}

TEST(TwoCurvedParameters, GiveTheSamePosterior) {
  const auto plant = test::Program(TwoPowers());
  test::GaussianNoise noise(0.1);
  std::vector<DataPack> packs;
  for (std::int64_t seq = 1; seq <= 8; ++seq) packs.push_back(PackOf(*plant, seq, &noise));
  test::ExpectSamePosteriors(DescribedSettings(plant), packs);
}

TEST(TwoCurvedParameters, AreLeftAloneWhereSumsCannotBeExact) {
  EXPECT_FALSE(TwoPowersCase(TwoPowers(), 1e-6, false, 0.1).Score(simd::Best()).ready()) << "digits of the sums";
  TwoPowersCase lost(TwoPowers(), 0.1, false, 0.1);
  lost.data->target[7] = std::nan("");
  EXPECT_FALSE(lost.Score(simd::Best()).ready());
  // Corners of either exponent: in what is a function of one, and in what is one of both.
  for (const char* law : {"K*x^p + B*v*x^max(q, 1.4) + c", "K*x^max(p, 1.7) + B*v*x^q + c"})
    EXPECT_FALSE(TwoPowersCase(TwoPowers(law), 0.1, false, 0.1).Score(simd::Best()).ready()) << law;
  // A dip that is narrower than the points are apart, in the second.
  const PlantDescription dip = TwoPowers("K*x^p + B*v*x^q*(1 - 0.5*exp(-((q - 1.4)/1e-4)^2)) + c");
  EXPECT_FALSE(TwoPowersCase(dip, 0.1, false, 0.1).Score(simd::Best()).ready());
  // Nine functions of both.
  PlantDescription many = TwoPowers("(K + c*v + d*v^2)*x^p + (B*v + e + g*v^3)*x^q");
  for (const char* name : {"d", "e", "g"}) many.parameters.push_back({name, "1", "normal", 0.0, 0.5, -2.0, 2.0});
  const auto plant = test::Program(many);
  ASSERT_EQ(plant->info().linear[0].num_linear, 6);
  const EstimatorSettings settings = DescribedSettings(plant);
  const NoiseModel noise(settings.noise[0]);
  const ParameterSpace space(settings, settings.noise[0]);
  EXPECT_FALSE(QuadraticScore(simd::Best(), -1, space, noise, plant->info().linear[0]).applies());
}

}  // namespace
}  // namespace armcmc::two_curved_test
