#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "armcmc/types.hpp"
#include "kernel_sets.hpp"

namespace armcmc {
namespace {

using test::Wide;

constexpr int kDim = 4;
constexpr int kCount = 1000;

/// Weighted points, padded with weight 0.
struct Cloud {
  std::vector<double> rows[kDim], weight;
  const double* u[kDim];

  Cloud() : weight(1024, 0.0) {
    std::mt19937_64 g(2);
    std::normal_distribution<double> normal;
    for (std::size_t d = 0; d < kDim; ++d) {
      rows[d].assign(1024, 1e30);  // finite padding must not leak
      for (std::size_t k = 0; k < kCount; ++k) rows[d][k] = 5.0 * static_cast<double>(d) + normal(g);
      u[d] = rows[d].data();
    }
    for (std::size_t k = 0; k < kCount; ++k) weight[k] = std::exp(normal(g));
  }
};

TEST(MomentKernels, EqualTheSums) {
  const Cloud c;
  const double mean[kDim] = {0.1, 5.2, 9.8, 15.0};
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    double first[2 + kMaxParams], second[kMaxParams * (kMaxParams + 1) / 2];
    kernels->first_moments(kDim, c.u, c.weight.data(), kCount, first);
    kernels->second_moments(kDim, c.u, c.weight.data(), mean, kCount, second);
    long double w = 0.0L, w2 = 0.0L;
    for (std::size_t k = 0; k < kCount; ++k) {
      w += Wide(c.weight[k]);
      w2 += Wide(c.weight[k]) * Wide(c.weight[k]);
    }
    EXPECT_NEAR(first[0] / static_cast<double>(w), 1.0, 1e-13);
    EXPECT_NEAR(first[1] / static_cast<double>(w2), 1.0, 1e-13);
    std::size_t t = 0;
    for (std::size_t i = 0; i < kDim; ++i) {
      long double m = 0.0L;
      for (std::size_t k = 0; k < kCount; ++k) m += Wide(c.weight[k]) * Wide(c.u[i][k]);
      EXPECT_NEAR(first[2 + i], static_cast<double>(m), 1e-13 * 20.0 * static_cast<double>(w)) << kernels->name;
      for (std::size_t j = 0; j <= i; ++j) {
        long double s = 0.0L;
        for (std::size_t k = 0; k < kCount; ++k)
          s += Wide(c.weight[k]) * (Wide(c.u[i][k]) - Wide(mean[i])) * (Wide(c.u[j][k]) - Wide(mean[j]));
        EXPECT_NEAR(second[t++], static_cast<double>(s), 1e-12 * static_cast<double>(w)) << kernels->name;
      }
    }
  }
}

TEST(MomentKernels, FusedInstructionSetsGiveTheSameBits) {
  const auto sets = test::FusedKernels();
  if (sets.size() < 2) GTEST_SKIP() << "this CPU runs one fused instruction set only";
  const Cloud c;
  const double mean[kDim] = {0.1, 5.2, 9.8, 15.0};
  double a[64] = {}, b[64] = {};
  sets[0]->first_moments(kDim, c.u, c.weight.data(), kCount, a);
  sets[1]->first_moments(kDim, c.u, c.weight.data(), kCount, b);
  EXPECT_EQ(std::memcmp(a, b, sizeof a), 0);
  sets[0]->second_moments(kDim, c.u, c.weight.data(), mean, kCount, a);
  sets[1]->second_moments(kDim, c.u, c.weight.data(), mean, kCount, b);
  EXPECT_EQ(std::memcmp(a, b, sizeof a), 0);
}

constexpr int kNodes = 21;
constexpr double kPerNode = 2.0, kOrigin = 10.0;  // nodes at -5, -4.5 .. 5 of the first row

TEST(HistogramKernel, SharesEachDrawBetweenTheNodesOfItsCell) {
  const Cloud c;
  std::vector<double> expected(2 * kNodes, 0.0);
  for (std::size_t k = 0; k < kCount; ++k) {
    const double place = std::min(std::max(c.rows[0][k] * kPerNode + kOrigin, 0.0), kNodes - 1.001);
    const auto cell = static_cast<std::size_t>(place);
    expected[2 * cell] += c.weight[k];
    expected[2 * cell + 1] += c.weight[k] * (place - std::floor(place));
  }
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    std::vector<double> cells(2 * kNodes, 0.0);
    kernels->histogram(c.u[0], c.weight.data(), kCount, kPerNode, kOrigin, kNodes, cells.data());
    for (std::size_t i = 0; i < cells.size(); ++i) EXPECT_NEAR(cells[i], expected[i], 1e-10) << kernels->name << i;
  }
}

TEST(HistogramKernel, HoldsWhatLiesBeyondTheNodes) {
  const std::vector<double> e = {-1e300, 1e300, std::nan(""), -5.0, 5.0, 0.0, 0.0, 0.0};
  const std::vector<double> weight = {1.0, 2.0, 0.0, 4.0, 8.0, 0.0, 0.0, 0.0};
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    std::vector<double> cells(2 * kNodes, 0.0);
    kernels->histogram(e.data(), weight.data(), 8, kPerNode, kOrigin, kNodes, cells.data());
    EXPECT_EQ(cells[0], 5.0) << kernels->name;
    EXPECT_EQ(cells[2 * (kNodes - 2)], 10.0) << kernels->name;
  }
}

TEST(HistogramKernel, FusedInstructionSetsGiveTheSameBits) {
  const auto sets = test::FusedKernels();
  if (sets.size() < 2) GTEST_SKIP() << "this CPU runs one fused instruction set only";
  const Cloud c;
  double a[2 * kNodes] = {}, b[2 * kNodes] = {};
  sets[0]->histogram(c.u[0], c.weight.data(), kCount, kPerNode, kOrigin, kNodes, a);
  sets[1]->histogram(c.u[0], c.weight.data(), kCount, kPerNode, kOrigin, kNodes, b);
  EXPECT_EQ(std::memcmp(a, b, sizeof a), 0);
}

}  // namespace
}  // namespace armcmc
