#include "armcmc/expression/elementary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "armcmc/expression/evaluate.hpp"
#include "core/kernel_sets.hpp"

namespace armcmc::elementary_test {
namespace {

using expression::Op;

constexpr std::size_t kCount = 64 * expression::kElementaryStride;

/// From one end of the range to the other, most of them near the middle; of a logarithm they are evenly many a decade.
std::vector<double> Arguments(Op op) {
  std::vector<double> arguments(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    const double place = 2.0 * static_cast<double>(i) / static_cast<double>(kCount - 1) - 1.0;
    arguments[i] = op == Op::kLog   ? std::pow(10.0, 300.0 * place)
                   : op == Op::kExp ? 690.0 * place
                                    : 1e6 * place * place * place * place * place;
  }
  return arguments;
}

TEST(Elementary, AgreesWithTheLibrary) {
  for (const simd::Kernels* kernels : test::RunnableKernels())
    for (const Op op : {Op::kExp, Op::kLog, Op::kSin, Op::kCos, Op::kTan, Op::kAtan, Op::kTanh}) {
      const std::vector<double> a = Arguments(op);
      std::vector<double> out(kCount);
      ASSERT_TRUE(kernels->elementary(op, kCount, a.data(), nullptr, out.data()));
      for (std::size_t i = 0; i < kCount; ++i) {
        const double expected = expression::Evaluate(op, a[i], 0.0, 0.0);
        // The reduction of large angles, which a tangent magnifies, keeps some 1e-15 of a turn.
        const double magnified = op == Op::kTan ? 1.0 + expected * expected : 1.0 + std::fabs(expected);
        EXPECT_NEAR(out[i], expected, 1e-14 * magnified)
            << expression::InfoOf(op).name << " of " << a[i] << ", " << kernels->name;
      }
    }
}

TEST(Elementary, ATinyHyperbolicTangentIsAsExactAsALargeOne) {
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    std::vector<double> x(kCount), out(kCount);
    for (std::size_t i = 0; i < kCount; ++i)
      x[i] = (i % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, 20.0 * static_cast<double>(i) / kCount - 18.0);
    ASSERT_TRUE(kernels->elementary(Op::kTanh, kCount, x.data(), nullptr, out.data()));
    for (std::size_t i = 0; i < kCount; ++i)
      EXPECT_NEAR(out[i], std::tanh(x[i]), 1e-15 * std::fabs(std::tanh(x[i]))) << x[i] << ", " << kernels->name;
  }
}

TEST(Elementary, PowersAreThoseOfTheLibrary) {
  for (const simd::Kernels* kernels : test::RunnableKernels()) {
    std::vector<double> base(kCount), exponent(kCount), out(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      base[i] = i == 0 ? 0.0 : std::pow(10.0, 12.0 * static_cast<double>(i) / kCount - 6.0);
      exponent[i] = 0.3 + 2.0 * std::sin(static_cast<double>(i));
    }
    exponent[0] = 0.5;
    ASSERT_TRUE(kernels->elementary(Op::kPower, kCount, base.data(), exponent.data(), out.data()));
    for (std::size_t i = 0; i < kCount; ++i) {
      const double expected = std::pow(base[i], exponent[i]);
      EXPECT_NEAR(out[i], expected, 1e-13 * expected) << base[i] << "^" << exponent[i] << ", " << kernels->name;
    }
  }
}

TEST(Elementary, WhatIsNoNumberStaysNone) {
  for (const Op op : {Op::kExp, Op::kLog, Op::kSin, Op::kCos, Op::kTan, Op::kAtan, Op::kTanh}) {
    std::vector<double> x(expression::kElementaryStride, std::numeric_limits<double>::quiet_NaN());
    ASSERT_TRUE(expression::Elementary(op, x.size(), x.data(), nullptr, x.data()));
    for (const double value : x) EXPECT_TRUE(std::isnan(value)) << expression::InfoOf(op).name;
  }
}

TEST(Elementary, TakesNoOtherOperation) {
  std::vector<double> a(expression::kElementaryStride, 2.0), out(a.size(), 7.0);
  for (const Op op : {Op::kAdd, Op::kSqrt, Op::kAsin, Op::kLowpass}) {
    EXPECT_FALSE(expression::Elementary(op, a.size(), a.data(), a.data(), out.data()));
    EXPECT_EQ(out.front(), 7.0);
  }
}

}  // namespace
}  // namespace armcmc::elementary_test
