#include "armcmc/density_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "armcmc/rng.hpp"
#include "core/weighted_sample.hpp"

namespace armcmc::density_fit_test {
namespace {

using Sample = test::WeightedSample;
using test::drawn_normal;

void Correlated(std::mt19937_64& g, double* u) {
  const double a = drawn_normal(g), b = drawn_normal(g), c = drawn_normal(g);
  u[0] = 100.0 + 2.0 * a;
  u[1] = -3.0 + 0.5 * a + 0.01 * b;
  u[2] = 1e-6 * (c + 0.3 * b);
}

void Banana(std::mt19937_64& g, double* u) {
  const double a = drawn_normal(g);
  u[0] = a;
  u[1] = 0.8 * (a * a - 1.0) + 0.2 * drawn_normal(g);
}

TEST(FitBlock, MeanAndCovarianceEqualThoseOfTheDraws) {
  Sample s(3, 5001, Correlated);
  std::mt19937_64 generator(8);
  for (std::size_t k = 0; k < 5001; ++k) s.weight[k] = std::exp(0.5 * drawn_normal(generator));
  const double ess = s.Fit();
  EXPECT_GT(ess, 1000.0);
  const double unbiased = 1.0 / (1.0 - 1.0 / ess);
  const ParamVector mean = MeanOf(s.block);
  const ParamMatrix covariance = CovarianceOf(s.block);
  for (int i = 0; i < 3; ++i) {
    const auto ii = static_cast<std::size_t>(i);
    const double sd_i = std::sqrt(s.Covariance(ii, ii));
    EXPECT_NEAR(mean[i], s.Mean(ii), 1e-9 * sd_i) << i;
    for (int j = 0; j < 3; ++j) {
      const auto jj = static_cast<std::size_t>(j);
      EXPECT_NEAR(covariance(i, j), unbiased * s.Covariance(ii, jj), 1e-9 * sd_i * std::sqrt(s.Covariance(jj, jj)))
          << i << j;
    }
  }
}

TEST(FitBlock, LawItselfHasTheMeanAndVarianceOfTheDraws) {
  // One coordinate: nothing bends, so that the moments of the tabulated marginal are those of the block.
  Sample s(1, 3000, [](std::mt19937_64& g, double* u) { u[0] = 7.0 + std::exp(0.5 * drawn_normal(g)); });
  const double ess = s.Fit();
  const double spread = s.block.unwhiten[0][0];
  const double mean = s.block.mean[0] + spread * (s.block.center[0] + s.block.scale[0] * s.tables[0].Mean());
  const double variance = std::pow(spread * s.block.scale[0], 2) * s.tables[0].Variance();
  EXPECT_NEAR(mean, s.Mean(0), 1e-9 * std::sqrt(s.Covariance(0, 0)));
  EXPECT_NEAR(variance / s.Covariance(0, 0), 1.0 / (1.0 - 1.0 / ess), 1e-9);
}

TEST(FitBlock, ReturnsTheKishSizeOfTheWeights) {
  Sample s(2, 400, Banana);
  EXPECT_NEAR(s.Fit(), 400.0, 1e-9);
  for (std::size_t k = 0; k < 400; ++k) s.weight[k] = k < 100 ? 3.0 : 0.0;
  EXPECT_NEAR(s.Fit(), 100.0, 1e-9);
}

TEST(FitBlock, WritesNothingForDegenerateWeights) {
  Sample s(2, 400, Banana);
  s.block.dim = 77;
  s.block.norm = -1.0;
  std::fill(s.weight.begin(), s.weight.end(), 0.0);
  EXPECT_LT(s.Fit(), kMinimumEss);
  s.weight[5] = 1.0;
  EXPECT_LT(s.Fit(), kMinimumEss);
  for (std::size_t k = 0; k < 400; ++k) s.weight[k] = k < 20 ? 1.0 : 1e-12;
  EXPECT_LT(s.Fit(), kMinimumEss);
  EXPECT_EQ(s.block.dim, 77);
  EXPECT_EQ(s.block.norm, -1.0);
  EXPECT_EQ(s.tables[0].num_nodes(), 0);
}

TEST(FitBlock, CoordinateWithoutSpreadStaysFinite) {
  Sample s(2, 500, [](std::mt19937_64& g, double* u) {
    u[0] = drawn_normal(g);
    u[1] = 4.0;
  });
  s.Fit();
  const double uniforms[] = {0.3, 0.6};
  double u[2];
  s.block.Draw(uniforms, u);
  EXPECT_TRUE(std::isfinite(u[0]));
  EXPECT_NEAR(u[1], 4.0, 1e-3);
  EXPECT_TRUE(std::isfinite(s.block.norm));
}

/// Mean log density of fresh draws of a law in two coordinates.
struct Scores {
  double fitted = 0.0, gaussian = 0.0, truth = 0.0;
};

Scores HeldOutScores(const std::function<void(std::mt19937_64&, double*)>& draw,
                     const std::function<double(const double*)>& log_density) {
  Sample s(2, 4000, draw);
  s.Fit();
  ParamVector mean(2);
  mean << s.Mean(0), s.Mean(1);
  ParamMatrix covariance(2, 2);
  covariance << s.Covariance(0, 0), s.Covariance(0, 1), s.Covariance(1, 0), s.Covariance(1, 1);
  const MarginalTable table = MarginalTable::Normal();
  DensityBlock gaussian;
  SetElliptic(mean, covariance, 1.0, &table, &gaussian);
  std::mt19937_64 generator(99);
  drawn_normal.reset();
  Scores scores;
  constexpr int kFresh = 4000;
  for (int k = 0; k < kFresh; ++k) {
    double u[2];
    draw(generator, u);
    scores.fitted += std::log(s.block.Density(u) + 1e-12) / kFresh;
    scores.gaussian += std::log(gaussian.Density(u) + 1e-12) / kFresh;
    scores.truth += log_density(u) / kFresh;
  }
  return scores;
}

TEST(FitBlock, BentRidgeScoresNearlyAsItsOwnLaw) {
  // Long, thin and curved, as K and p are under poor excitation.
  const auto ridge = [](std::mt19937_64& g, double* u) {
    u[0] = drawn_normal(g);
    u[1] = -u[0] + 0.1 * (u[0] * u[0] - 1.0) + 0.03 * drawn_normal(g);
  };
  const Scores scores = HeldOutScores(ridge, [](const double* u) {
    const double z = (u[1] + u[0] - 0.1 * (u[0] * u[0] - 1.0)) / 0.03;
    return -0.5 * (u[0] * u[0] + z * z) - std::log(2.0 * M_PI * 0.03);
  });
  EXPECT_GT(scores.fitted, scores.gaussian + 0.8);
  EXPECT_GT(scores.fitted, scores.truth - 0.2);
}

/// E_q[p / q] = 1 for q of which the draws have the density, and p that integrates to one inside its support.
void ExpectUnitRatio(const DensityBlock& q, const DensityBlock& p) {
  RandomStream stream(21, 0, 0);
  constexpr int kCount = 200'000;
  double sum = 0.0, square = 0.0;
  for (int k = 0; k < kCount; ++k) {
    double uniforms[kMaxParams] = {}, u[kMaxParams] = {};
    for (int d = 0; d < q.dim; ++d) uniforms[d] = stream.Uniform();
    q.Draw(uniforms, u);
    const double w = p.Density(u) / q.Density(u);
    sum += w;
    square += w * w;
  }
  EXPECT_LT(std::sqrt(square) / kCount, 0.03) << "the identity must have teeth";
  EXPECT_NEAR(sum / kCount, 1.0, 4.0 * std::sqrt(square) / kCount);
}

/// The fitted block against a wide block of another shape, and a narrow one against it.
void ExpectDensityOfItsDraws(const Sample& s) {
  const int dim = s.draws.dim;
  ParamMatrix covariance(dim, dim);
  ParamVector mean(dim);
  for (int i = 0; i < dim; ++i) {
    mean[i] = s.Mean(static_cast<std::size_t>(i));
    for (int j = 0; j < dim; ++j)
      covariance(i, j) = s.Covariance(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
  }
  const MarginalTable student = MarginalTable::StudentT(4.0);
  DensityBlock wide, narrow;
  SetElliptic(mean, covariance, 1.5, &student, &wide);
  SetElliptic(mean, covariance, 0.3, &student, &narrow);
  ExpectUnitRatio(wide, s.block);
  ExpectUnitRatio(s.block, narrow);
}

TEST(FitBlock, BentDensityIsThatOfItsDraws) {
  Sample s(3, 4000, [](std::mt19937_64& g, double* u) {
    Banana(g, u);
    u[2] = 0.5 * u[0] + 0.4 * u[0] * u[1] + 0.7 * drawn_normal(g);
  });
  s.Fit();
  EXPECT_TRUE(s.block.bent);
  ExpectDensityOfItsDraws(s);
}

TEST(FitBlock, TaperedDensityIsThatOfItsDraws) {
  Sample s(2, 4000, [](std::mt19937_64& g, double* u) {
    u[0] = drawn_normal(g);
    u[1] = 2.0 * u[0] + 0.5 * std::exp(0.4 * u[0]) * drawn_normal(g);
  });
  s.Fit();
  EXPECT_TRUE(s.block.tapered);
  ExpectDensityOfItsDraws(s);
}

TEST(FitBlock, DoesNotDependOnTheScaleOfACoordinate) {
  const auto draw = [](std::mt19937_64& g, double* u) {
    Banana(g, u);
    u[1] += 0.6 * u[0];
  };
  Sample plain(2, 2000, draw), scaled(2, 2000, draw);
  for (double& v : scaled.row[0]) v *= 1e-6;
  for (double& v : scaled.row[1]) v = 1e4 * v + 3e4;
  plain.Fit();
  scaled.Fit();
  for (std::size_t k = 0; k < 200; ++k) {
    const double u[] = {plain.row[0][k], plain.row[1][k]}, v[] = {scaled.row[0][k], scaled.row[1][k]};
    const double p = plain.block.Density(u);
    EXPECT_NEAR(scaled.block.Density(v) * 1e-2, p, 1e-6 * p);
  }
}

TEST(AppendIndependent, MultipliesByALawOfItsOwn) {
  Sample s(2, 2000, &Banana);
  s.Fit();
  const DensityBlock before = s.block;
  const MarginalTable law = MarginalTable::StudentT(5.0);
  MarginalTable table;
  AppendIndependent(-0.4, 0.25, law, &table, &s.block);
  ASSERT_EQ(s.block.dim, 3);
  EXPECT_DOUBLE_EQ(MeanOf(s.block)[2], -0.4);
  EXPECT_NEAR(CovarianceOf(s.block)(2, 2), 0.25 * 0.25, 1e-12);
  const double unit = std::sqrt(law.Variance()) / 0.25;
  for (const double third : {-2.0, -0.4, -0.1, 1.5}) {
    const double u[] = {s.row[0][7], s.row[1][7], third};
    EXPECT_NEAR(s.block.Density(u), before.Density(u) * law.Density((third + 0.4) * unit) * unit, 1e-9);
  }
}

TEST(FitBlock, InflationWidensEveryCoordinate) {
  Sample s(1, 4000, [](std::mt19937_64& g, double* u) { u[0] = drawn_normal(g); });
  s.Fit();
  const double scale = s.block.scale[0];
  s.Fit({.inflation = 1.5});
  EXPECT_NEAR(s.block.scale[0] / scale, 1.5, 1e-9);
}

TEST(FitBlock, RepeatedCompressionNeitherWidensNorShifts) {
  constexpr int kSize = 4096;
  Sample s(3, kSize, Correlated);
  s.Fit();
  double mean[3], sd[3];
  for (std::size_t d = 0; d < 3; ++d) {
    mean[d] = s.Mean(d);
    sd[d] = std::sqrt(s.Covariance(d, d));
  }
  // Each round draws a Latin hypercube from the block and compresses it again. Stratified draws have next to no
  // Monte-Carlo error of their own, so that what adds up over 200 rounds is the bias of a compression.
  std::mt19937_64 generator(17);
  std::vector<int> order(kSize);
  for (int k = 0; k < kSize; ++k) order[static_cast<std::size_t>(k)] = k;
  std::vector<double> strata[3];
  for (int round = 0; round < 200; ++round) {
    for (auto& stratum : strata) {
      std::shuffle(order.begin(), order.end(), generator);
      stratum.clear();
      for (const int k : order)
        stratum.push_back((k + std::uniform_real_distribution<double>(0.001, 0.999)(generator)) / kSize);
    }
    const DensityBlock block = s.block;
    MarginalTable tables[3] = {s.tables[0], s.tables[1], s.tables[2]};
    DensityBlock source = block;
    for (std::size_t d = 0; d < 3; ++d) source.marginal[d] = &tables[d];
    for (std::size_t k = 0; k < kSize; ++k) {
      const double uniforms[] = {strata[0][k], strata[1][k], strata[2][k]};
      double u[3];
      source.Draw(uniforms, u);
      for (std::size_t d = 0; d < 3; ++d) s.row[d][k] = u[d];
    }
    s.Fit();
  }
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(s.Mean(d), mean[d], 0.05 * sd[d]) << d;
    EXPECT_NEAR(std::sqrt(s.Covariance(d, d)) / sd[d], 1.0, 0.1) << d;
  }
}

TEST(SetElliptic, IsTheGaussianItIsAskedFor) {
  const MarginalTable table = MarginalTable::Normal();
  ParamVector mean(2);
  mean << 1.0, -2.0;
  ParamMatrix covariance(2, 2);
  covariance << 2.0, 0.9, 0.9, 0.7;
  DensityBlock block;
  SetElliptic(mean, covariance, 1.0, &table, &block);
  const double u[] = {1.4, -1.5};
  const double det = 2.0 * 0.7 - 0.81, a = 0.4, b = 0.5;
  const double square = (0.7 * a * a - 1.8 * a * b + 2.0 * b * b) / det;
  const double expected = std::exp(-0.5 * square) / (2.0 * M_PI * std::sqrt(det));
  EXPECT_NEAR(block.Density(u) / expected, 1.0, 0.01) << "tabulated at 8 nodes a standard deviation";
  EXPECT_LT((CovarianceOf(block) - covariance).cwiseAbs().maxCoeff(), 1e-12);
}

/// Largest difference between a marginal's density and the normal one, within three standard deviations.
double Roughness(const Sample& sample, std::size_t i) {
  double worst = 0.0;
  for (double x = -3.0; x <= 3.0; x += 0.05) {
    double density = sample.block.marginal[i]->Density((x - sample.block.center[i]) / sample.block.scale[i]);
    density /= sample.block.scale[i];
    worst = std::max(worst, std::fabs(density - std::exp(-0.5 * x * x) / std::sqrt(2.0 * M_PI)));
  }
  return worst;
}

TEST(FitBlock, RoughnessThatIsChanceIsNotHandedOn) {
  const auto bell = [](std::mt19937_64& g, double* u) { u[0] = std::normal_distribution<double>()(g); };
  double plain = 0.0, shrunk = 0.0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Sample sample(1, 6000, bell, seed);
    sample.Fit({.bandwidth_factor = 0.7, .tail_weight = 0.0});
    plain += Roughness(sample, 0) / 20.0;
    sample.Fit({.bandwidth_factor = 0.7, .tail_weight = 0.0, .shrink_to_normal = true});
    shrunk += Roughness(sample, 0) / 20.0;
  }
  EXPECT_LT(shrunk, 0.6 * plain);
}

TEST(FitBlock, AShapeBeyondChanceIsHandedOn) {
  const auto skewed = [](std::mt19937_64& g, double* u) { u[0] = std::gamma_distribution<double>(6.0)(g); };
  Sample sample(1, 6000, skewed);
  sample.Fit({.bandwidth_factor = 0.7, .tail_weight = 0.0});
  const double plain = Roughness(sample, 0);
  sample.Fit({.bandwidth_factor = 0.7, .tail_weight = 0.0, .shrink_to_normal = true});
  EXPECT_GT(plain, 0.05) << "a gamma law is not normal";
  EXPECT_NEAR(Roughness(sample, 0), plain, 0.02 * plain);
}

}  // namespace
}  // namespace armcmc::density_fit_test
