#include "armcmc/control_variates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

#include "simd/kernels.hpp"

namespace armcmc::control_variates_test {
namespace {

constexpr double kFar = 500.0;  // of the coordinates from 0, as posteriors are that have contracted

/// Draws of two coordinates from a normal proposal of standard deviation `spread` about (kFar, -kFar).
class Sample {
 public:
  Sample(int size, double spread, unsigned seed, const std::function<double(double, double)>& target) {
    const auto padded = static_cast<std::size_t>(RoundUpToTile(size));
    for (auto* row : {&u_[0], &u_[1], &q_, &weight_, &scratch_[0], &scratch_[1]}) row->assign(padded, 0.0);
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> normal;
    double sum = 0.0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(size); ++k) {
      const double a = spread * normal(generator), b = spread * normal(generator);
      u_[0][k] = kFar + a;
      u_[1][k] = -kFar + b;
      q_[k] = std::exp(-0.5 * (a * a + b * b) / (spread * spread)) / (2.0 * M_PI * spread * spread);
      sum += weight_[k] = target(a, b) / q_[k];
    }
    for (double& w : weight_) w /= sum;
    draws_ = {.size = size, .u = {u_[0].data(), u_[1].data()}, .proposal = q_.data(), .weight = weight_.data()};
  }

  bool Reduce(const Gaussian& guide) {
    return ReduceVariance(simd::Best(), guide, &table_, draws_, {scratch_[0].data(), scratch_[1].data()});
  }
  /// Mean of a coordinate about the middle of the proposal.
  [[nodiscard]] double Mean(int d) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < weight_.size(); ++k) sum += weight_[k] * (u_[d][k] - (d == 0 ? kFar : -kFar));
    return sum;
  }
  /// Mean of a product of two coordinates about the middle of the proposal.
  [[nodiscard]] double Product(int d, int e) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < weight_.size(); ++k)
      sum += weight_[k] * (u_[d][k] - (d == 0 ? kFar : -kFar)) * (u_[e][k] - (e == 0 ? kFar : -kFar));
    return sum;
  }
  [[nodiscard]] double Total() const { return std::accumulate(weight_.begin(), weight_.end(), 0.0); }
  [[nodiscard]] const std::vector<double>& weight() const { return weight_; }

 private:
  MarginalTable table_ = MarginalTable::Normal();
  std::vector<double> u_[2], q_, weight_, scratch_[2];
  ProposalDraws draws_;
};

double Bell(double a, double b) { return std::exp(-0.5 * (a * a + b * b)); }
/// Skew-normal of shape 1.5 in the first coordinate, which no Gaussian guide matches.
double Skewed(double a, double b) { return Bell(a, b) * 0.5 * std::erfc(-1.5 * a / std::sqrt(2.0)); }

Gaussian Guide(double a, double b, double precision = 1.0) {
  Gaussian guide{ParamVector(2), ParamMatrix::Identity(2, 2) * precision};
  guide.mean << kFar + a, -kFar + b;
  return guide;
}

TEST(ControlVariates, KnowAGaussianTargetsMeanExactly) {
  Sample sample(4096, 1.5, 1, Bell);
  const double before = std::hypot(sample.Mean(0), sample.Mean(1));
  ASSERT_TRUE(sample.Reduce(Guide(0.0, 0.0)));
  const double after = std::hypot(sample.Mean(0), sample.Mean(1));
  EXPECT_GT(before, 3e-3) << "what four thousand draws leave";
  EXPECT_LT(after, 1e-4) << "what the table of the normal law leaves";
  EXPECT_NEAR(sample.Total(), 1.0, 1e-12);
}

TEST(ControlVariates, KnowAGaussianTargetsCovarianceTenTimesBetterThanTheDraws) {
  constexpr double kCorrelation = 0.6;
  const auto tilted = [](double a, double b) {
    return std::exp(-0.5 * (a * a - 2.0 * kCorrelation * a * b + b * b) / (1.0 - kCorrelation * kCorrelation));
  };
  Gaussian guide{ParamVector(2), ParamMatrix(2, 2)};
  guide.mean << kFar, -kFar;
  guide.precision << 1.0, -kCorrelation, -kCorrelation, 1.0;
  guide.precision *= 1.0 / (1.0 - kCorrelation * kCorrelation);
  constexpr int kRuns = 100;
  double before = 0.0, after = 0.0;
  const auto error = [](const Sample& sample) {
    return std::pow(sample.Product(0, 0) - 1.0, 2) + std::pow(sample.Product(1, 1) - 1.0, 2) +
           std::pow(sample.Product(0, 1) - kCorrelation, 2);
  };
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    Sample sample(4096, 1.3, 500 + seed, tilted);
    before += error(sample);
    ASSERT_TRUE(sample.Reduce(guide));
    after += error(sample);
  }
  EXPECT_LT(std::sqrt(after / before), 0.1) << std::sqrt(before / kRuns) << " -> " << std::sqrt(after / kRuns);
}

/// Root mean square error of the first mean over many samples, without and with control variates, and the mean error.
struct Errors {
  double raw = 0.0, reduced = 0.0, bias = 0.0;
};
Errors ErrorsOf(const std::function<double(double, double)>& target, double truth, const Gaussian& guide) {
  constexpr int kRuns = 400;
  Errors e;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    Sample sample(1024, 1.5, 100 + seed, target);
    e.raw += std::pow(sample.Mean(0) - truth, 2) / kRuns;
    EXPECT_TRUE(sample.Reduce(guide));
    e.reduced += std::pow(sample.Mean(0) - truth, 2) / kRuns;
    e.bias += (sample.Mean(0) - truth) / kRuns;
  }
  e.raw = std::sqrt(e.raw);
  e.reduced = std::sqrt(e.reduced);
  return e;
}

TEST(ControlVariates, AreRightForATargetThatTheGuideDoesNotKnow) {
  const double truth = std::sqrt(2.0 / M_PI) * 1.5 / std::sqrt(1.0 + 1.5 * 1.5);  // mean of the skew-normal law
  const Errors e = ErrorsOf(Skewed, truth, Guide(0.4, 0.0));
  EXPECT_LT(e.reduced, 0.75 * e.raw);
  EXPECT_LT(std::fabs(e.bias), 3.0 * e.reduced / 20.0 + 1e-3) << "no bias beyond chance and O(1 / draws)";
}

TEST(ControlVariates, AWrongGuideDoesNoHarm) {
  const Errors e = ErrorsOf(Bell, 0.0, Guide(0.6, -0.4));
  EXPECT_LT(e.reduced, 1.05 * e.raw);
  EXPECT_LT(std::fabs(e.bias), 3.0 * e.reduced / 20.0 + 1e-3);
}

TEST(ControlVariates, LeaveTheWeightsAloneWithoutAUsableGuide) {
  Sample sample(2048, 1.0, 7, Bell);
  const std::vector<double> before = sample.weight();
  EXPECT_FALSE(sample.Reduce(Guide(6.0, 0.0))) << "where nothing was drawn";
  EXPECT_FALSE(sample.Reduce(Guide(0.0, 0.0, 1e8))) << "narrower than the draws are dense";
  EXPECT_EQ(sample.weight(), before);
  Sample few(32, 1.5, 7, Bell);
  EXPECT_FALSE(few.Reduce(Guide(0.0, 0.0))) << "three coefficients from thirty draws";
}

}  // namespace
}  // namespace armcmc::control_variates_test
