#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "armcmc/types.hpp"
#include "core/kernel_sets.hpp"

namespace armcmc::moment_kernels_test {
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

TEST(SumKernels, FusedInstructionSetsGiveTheSameBits) {
  const auto sets = test::FusedKernels();
  if (sets.size() < 2) GTEST_SKIP() << "this CPU runs one fused instruction set only";
  const Cloud c;
  const double mean[kDim] = {0.1, 5.2, 9.8, 15.0};
  double a[64] = {}, b[64] = {};
  sets[0]->first_moments(kDim, c.u, c.weight.data(), kCount, a);
  sets[1]->first_moments(kDim, c.u, c.weight.data(), kCount, b);
  EXPECT_EQ(std::memcmp(a, b, sizeof a), 0) << "first moments";
  sets[0]->second_moments(kDim, c.u, c.weight.data(), mean, kCount, a);
  sets[1]->second_moments(kDim, c.u, c.weight.data(), mean, kCount, b);
  EXPECT_EQ(std::memcmp(a, b, sizeof a), 0) << "second moments";
  std::fill_n(a, 2 * kNodes, 0.0);
  std::fill_n(b, 2 * kNodes, 0.0);
  sets[0]->histogram(c.u[0], c.weight.data(), kCount, kPerNode, kOrigin, kNodes, a);
  sets[1]->histogram(c.u[0], c.weight.data(), kCount, kPerNode, kOrigin, kNodes, b);
  EXPECT_EQ(std::memcmp(a, b, sizeof a), 0) << "histogram";
}

/// Scored candidates, some of them outside the bounds, without a proposal, or without a likelihood.
struct Scored {
  static constexpr int kSize = 64;
  alignas(64) double likelihood[kSize], initial[kSize], first[kSize], second[kSize], proposal[kSize];
  simd::PriorTerms prior;

  Scored() {
    std::mt19937_64 g(12);
    std::uniform_real_distribution<double> some(0.1, 2.0);
    for (std::size_t k = 0; k < kSize; ++k) {
      for (auto* row : {likelihood, initial, first, second, proposal}) row[k] = some(g);
      if (k % 7 == 3) initial[k] = 0.0;
    }
    proposal[11] = 0.0;
    likelihood[20] = std::nan("");
    likelihood[33] = HUGE_VAL;
    likelihood[31] = 100.0;  // outside the bounds
    prior.initial = initial;
    prior.initial_share = 0.3;
    prior.memory[0] = first;
    prior.memory[1] = second;
    prior.memory_share[0] = 0.5;
    prior.memory_share[1] = 0.2;
  }
  Scored(const Scored&) = delete;  // the prior points into it
  Scored& operator=(const Scored&) = delete;
  [[nodiscard]] double Prior(std::size_t k) const { return 0.3 * initial[k] + 0.5 * first[k] + 0.2 * second[k]; }
};

TEST(WeightKernels, WeighLikelihoodTimesPriorOverProposal) {
  const Scored s;
  for (const simd::Kernels* kernels : test::RunnableKernels())
    for (const bool with_proposal : {true, false}) {
      alignas(64) double weight[Scored::kSize];
      std::copy_n(s.likelihood, Scored::kSize, weight);
      kernels->weigh(s.prior, with_proposal ? s.proposal : nullptr, Scored::kSize, weight);
      for (std::size_t k = 0; k < Scored::kSize; ++k) {
        const double expected = s.likelihood[k] * s.Prior(k) / (with_proposal ? s.proposal[k] : 1.0);
        if (s.initial[k] > 0.0 && std::isfinite(expected)) {
          EXPECT_NEAR(weight[k], expected, 1e-14 * expected) << kernels->name << " " << k;
        } else {
          EXPECT_EQ(weight[k], 0.0) << kernels->name << " " << k;
        }
      }
    }
}

TEST(WeightKernels, ShareEachDrawAmongItsPriors) {
  const Scored s;
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    alignas(64) double first_share[Scored::kSize];
    double sums[2], expected[2] = {};
    kernels->share_prior(s.prior, s.second, Scored::kSize, first_share, sums);
    for (std::size_t k = 0; k < Scored::kSize; ++k) {
      const double share = 0.5 * s.first[k] / s.Prior(k);
      EXPECT_NEAR(first_share[k], share, 1e-14) << kernels->name << " " << k;
      expected[0] += s.second[k] * share;
      expected[1] += s.second[k] * 0.3 * s.initial[k] / s.Prior(k);
    }
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(sums[i], expected[i], 1e-12) << kernels->name;
  }
}

TEST(WeightKernels, FindTheBestUsableCandidate) {
  const Scored s;
  double largest = 0.0;
  for (std::size_t k = 0; k < Scored::kSize; ++k)
    if (s.initial[k] > 0.0 && std::isfinite(s.likelihood[k])) largest = std::max(largest, s.likelihood[k]);
  ASSERT_LE(largest, 2.0);
  const std::vector<double> nowhere(Scored::kSize, 0.0);
  std::vector<double> a(Scored::kSize, 1.0), b(Scored::kSize, 2.0);
  a[42] = a[30] = b[10] = 3.0;  // 3 x 2 twice, 1 x 3
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    EXPECT_EQ(kernels->largest_inside(s.likelihood, s.initial, Scored::kSize), largest) << kernels->name;
    EXPECT_EQ(kernels->largest_inside(s.likelihood, nowhere.data(), Scored::kSize), -HUGE_VAL) << kernels->name;
    EXPECT_EQ(kernels->largest_product(a.data(), b.data(), Scored::kSize), 30) << kernels->name;
    EXPECT_EQ(kernels->largest_product(b.data(), nullptr, Scored::kSize), 10) << kernels->name;
  }
}

}  // namespace
}  // namespace armcmc::moment_kernels_test
