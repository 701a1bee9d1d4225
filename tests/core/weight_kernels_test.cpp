#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "armcmc/end_of_pack.hpp"
#include "armcmc/rng.hpp"
#include "core/kernel_sets.hpp"

namespace armcmc::weight_kernels_test {
namespace {

constexpr int kCount = 1000;  // a multiple of 8, and not of a tile

std::vector<double> Normals(unsigned seed) {
  std::mt19937_64 g(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(kCount);
  for (double& v : values) v = normal(g);
  return values;
}

TEST(DivideKernel, DividesInPlaceToo) {
  const std::vector<double> values = Normals(1);
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    std::vector<double> out(kCount), same = values;
    kernels->divide(values.data(), 3.0, kCount, out.data());
    kernels->divide(same.data(), 3.0, kCount, same.data());
    for (std::size_t k = 0; k < kCount; ++k) ASSERT_EQ(out[k], values[k] / 3.0) << kernels->name;
    EXPECT_EQ(out, same) << kernels->name;
  }
}

TEST(RatioKernel, IsZeroWhereTheDivisorIsNotPositive) {
  const std::vector<double> a = Normals(2);
  std::vector<double> b = Normals(3);
  b[4] = 0.0;
  b[5] = std::nan("");
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    std::vector<double> out(kCount);
    kernels->ratio(a.data(), b.data(), kCount, out.data());
    for (std::size_t k = 0; k < kCount; ++k) ASSERT_EQ(out[k], b[k] > 0.0 ? a[k] / b[k] : 0.0) << kernels->name << k;
  }
}

TEST(MoveToEndKernel, IsThatOfOneDraw) {
  std::vector<double> v = Normals(8);
  v[7] = 9.0;
  v[8] = -9.0;
  EndOfPack::Quantiles effective{}, at_end{};
  for (std::size_t k = 0; k < effective.size(); ++k) {
    effective[k] = static_cast<double>(k) - 3.0;
    at_end[k] = 0.3 + 0.1 * effective[k] + 0.02 * std::pow(effective[k], 3);
  }
  const EndOfPack end(effective, at_end, 0.01, 0.9, -1.5, 1.7);
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    std::vector<double> u(kCount);
    kernels->move_to_end(end, v.data(), kCount, u.data());
    for (std::size_t k = 0; k < kCount; ++k) ASSERT_EQ(u[k], end(v[k])) << kernels->name << k;
    EXPECT_EQ(u[7], 1.7) << kernels->name;
    EXPECT_EQ(u[8], -1.5) << kernels->name;
  }
}

TEST(ReweighKernel, MultipliesByTheQuadraticControlAndNeverBelowZero) {
  const std::vector<double> u0 = Normals(4), u1 = Normals(5), g = Normals(6), before = Normals(7);
  const double* const u[] = {u0.data(), u1.data()};
  std::vector<double> fused;
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    std::vector<double> weight = before;
    const double sum = kernels->reweigh(test::kControl, u, g.data(), kCount, weight.data());
    double expected_sum = 0.0;
    int none = 0;
    for (std::size_t k = 0; k < kCount; ++k) {
      const double a = u0[k] - 0.1, b = u1[k] + 0.4;
      const double inner = 0.3 - 0.7 * a + 0.2 * b + 0.15 * a * a - 0.3 * a * b + 0.05 * b * b;
      const double expected = before[k] * std::fmax(0.5 - g[k] * inner, 0.0);
      ASSERT_NEAR(weight[k], expected, 1e-14) << kernels->name << " " << k;
      expected_sum += expected;
      none += expected == 0.0 ? 1 : 0;
    }
    EXPECT_GT(none, 100);  // else the bound is not tried
    EXPECT_NEAR(sum, expected_sum, 1e-11) << kernels->name;
    if (kernels == &simd::kPortableKernels) continue;
    if (fused.empty()) fused = weight;
    EXPECT_EQ(fused, weight) << kernels->name;
  }
}

TEST(TiltKernel, PutsTheQuadraticInThePlaceOfTheLogLikelihood) {
  const std::vector<double> u0 = Normals(4), u1 = Normals(5), before = Normals(7);
  std::vector<double> log_likelihood = Normals(6);
  log_likelihood[3] = -1e4;  // beyond what an exponent may be
  log_likelihood[8] = std::nan("");
  log_likelihood[9] = -HUGE_VAL;
  const double* const u[] = {u0.data(), u1.data()};
  std::vector<double> fused;
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    std::vector<double> weight = before;
    weight[3] = weight[8] = weight[9] = 1.0;
    kernels->tilt(test::kControl, u, log_likelihood.data(), kCount, weight.data());
    for (std::size_t k = 0; k < kCount; ++k) {
      const double a = u0[k] - 0.1, b = u1[k] + 0.4;
      const double q = 0.3 - 0.7 * a + 0.2 * b + 0.15 * a * a - 0.3 * a * b + 0.05 * b * b;
      const double expected = std::isfinite(log_likelihood[k]) && k != 3
                                  ? std::fmax(before[k], 0.0) * std::exp(q - log_likelihood[k])
                                  : 0.0;
      if (k == 3) {
        EXPECT_NEAR(weight[k] / std::exp(simd::kMostTilt), 1.0, 1e-9) << kernels->name;
      } else {
        ASSERT_NEAR(weight[k], expected, 1e-9 * expected) << kernels->name << " " << k;
      }
    }
    if (kernels == &simd::kPortableKernels) continue;
    if (fused.empty()) fused = weight;
    EXPECT_EQ(fused, weight) << kernels->name;
  }
}

TEST(ChooseKernel, CountsTheBoundsThatAreNotAbove) {
  RandomStream stream(1, 2, 3);
  std::vector<double> pick(kCount);
  for (double& p : pick) p = stream.Uniform();
  const double bounds[] = {0.1, 0.35, 0.35, 0.8};
  pick[10] = 0.35;  // on a bound
  for (const simd::Kernels* kernels : test::RunnableKernels())
    for (int num = 0; num <= 4; ++num) {
      std::vector<std::int8_t> choice(kCount, 99);
      kernels->choose(pick.data(), bounds, num, kCount, choice.data());
      for (std::size_t k = 0; k < kCount; ++k) {
        int expected = 0;
        for (int b = 0; b < num; ++b) expected += pick[k] >= bounds[b] ? 1 : 0;
        ASSERT_EQ(choice[k], expected) << kernels->name << " " << k << " of " << num;
      }
    }
}

TEST(CountChosenKernel, CountsThoseInsideAmongThem) {
  std::vector<double> inside = Normals(8);
  inside[3] = std::nan("");
  std::vector<std::int8_t> choice(kCount);
  for (std::size_t k = 0; k < kCount; ++k) choice[k] = static_cast<std::int8_t>(k * 7 % 32);
  for (const simd::Kernels* kernels : test::RunnableKernels())
    for (const int limit : {0, 1, 5, 32}) {
      int chosen = 0, both = 0;
      for (std::size_t k = 0; k < kCount; ++k) {
        chosen += choice[k] < limit ? 1 : 0;
        both += choice[k] < limit && inside[k] > 0.0 ? 1 : 0;
      }
      const auto counted = kernels->count_chosen(choice.data(), limit, inside.data(), kCount);
      EXPECT_EQ(counted.chosen, chosen) << kernels->name;
      EXPECT_EQ(counted.inside, both) << kernels->name;
    }
}

TEST(UniformsOfKernel, IsTheNumberOfEachMember) {
  RandomStream stream(9, 8, 7);
  const std::uint64_t origin = stream.origin();
  std::vector<double> expected(9 * 1024);
  for (double& v : expected) v = stream.Uniform();
  std::vector<std::int16_t> member(kCount);
  for (std::size_t k = 0; k < kCount; ++k) member[k] = static_cast<std::int16_t>(k * 331 % 1024);
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    std::vector<double> out(kCount);
    kernels->uniforms_of(origin, 2, 8, member.data(), kCount, out.data());
    for (std::size_t k = 0; k < kCount; ++k)
      ASSERT_EQ(out[k], expected[2 + 8 * static_cast<std::size_t>(member[k])]) << kernels->name;
  }
}

}  // namespace
}  // namespace armcmc::weight_kernels_test
