#include "armcmc/marginal_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace armcmc::marginal_table_test {
namespace {

constexpr double kStep = 1.0 / MarginalTable::kNodesPerUnit;

MarginalTable FromValues(const std::vector<double>& values, double lower) {
  MarginalTable table;
  table.Build(values.data(), static_cast<int>(values.size()), lower);
  return table;
}

double Upper(const MarginalTable& t) { return t.lower() + (t.num_nodes() - 1) * kStep; }

/// Integral of f(x) density(x), by Simpson's rule within each cell: exact for quadratic f.
template <class F>
double Expectation(const MarginalTable& t, F f) {
  double sum = 0.0;
  for (int i = 0; i + 1 < t.num_nodes(); ++i) {
    const double a = t.lower() + i * kStep;
    const double d0 = t.pdf()[i], d1 = t.pdf()[i + 1], m = a + 0.5 * kStep;
    sum += kStep / 6.0 * (f(a) * d0 + 4.0 * f(m) * 0.5 * (d0 + d1) + f(a + kStep) * d1);
  }
  return sum;
}

/// CDF at x from the public nodes.
double Cdf(const MarginalTable& t, double x) {
  const double position = std::clamp((x - t.lower()) / kStep, 0.0, t.num_nodes() - 1.0);
  const int node = std::min(static_cast<int>(position), t.num_nodes() - 2);
  double sum = 0.0;
  for (int i = 0; i < node; ++i) sum += 0.5 * kStep * (t.pdf()[i] + t.pdf()[i + 1]);
  const double s = (position - node) * kStep;
  const double slope = (t.pdf()[node + 1] - t.pdf()[node]) / kStep;
  return sum + t.pdf()[node] * s + 0.5 * slope * s * s;
}

std::vector<std::pair<std::string, MarginalTable>> Tables() {
  std::vector<double> skewed, gap(60, 0.0);
  for (int i = 0; i < 120; ++i) skewed.push_back(std::exp(-0.05 * i) * (1.0 + std::sin(0.3 * i)));
  for (std::size_t i = 5; i < 15; ++i) gap[i] = 1.0;
  for (std::size_t i = 40; i < 45; ++i) gap[i] = 3.0;
  return {{"normal", MarginalTable::Normal()},
          {"student", MarginalTable::StudentT(3.0)},
          {"uniform", MarginalTable::Uniform(1.7320508)},
          {"skewed", FromValues(skewed, -2.0)},
          {"with a gap and empty ends", FromValues(gap, 10.0)},
          {"one cell", FromValues({1.0, 3.0}, 0.5)}};
}

TEST(MarginalTable, DensityIsLinearBetweenNodesAndZeroOutside) {
  for (const auto& [name, table] : Tables()) {
    for (int i = 0; i + 1 < table.num_nodes(); ++i) {
      const double x = table.lower() + (i + 0.25) * kStep;
      EXPECT_NEAR(table.Density(x), 0.75 * table.pdf()[i] + 0.25 * table.pdf()[i + 1], 1e-12) << name;
    }
    EXPECT_EQ(table.Density(table.lower() - 1e-9), 0.0);
    EXPECT_EQ(table.Density(Upper(table) + 1e-9), 0.0);
    EXPECT_EQ(table.Density(std::nan("")), 0.0);
  }
}

TEST(MarginalTable, MeanAndVarianceAreExact) {
  for (const auto& [name, table] : Tables()) {
    const double mean = Expectation(table, [](double x) { return x; });
    const double variance = Expectation(table, [&](double x) { return (x - mean) * (x - mean); });
    EXPECT_NEAR(table.Mean(), mean, 1e-12) << name;
    EXPECT_NEAR(table.Variance(), variance, 1e-12) << name;
  }
}

TEST(MarginalTable, DrawIsTheInverseOfTheCdf) {
  for (const auto& [name, table] : Tables()) {
    for (int i = 1; i < 4000; ++i) {
      const double u = i / 4000.0;
      EXPECT_NEAR(Cdf(table, table.Draw(u)), u, 1e-12) << name;
    }
  }
}

TEST(MarginalTable, ExtremeUniformsStayInside) {
  for (const auto& [name, table] : Tables())
    for (const double u : {5e-324, 1e-300, 1e-17, 1.1e-16, 1.0 - 1.2e-16, std::nextafter(1.0, 0.0)}) {
      const double x = table.Draw(u);
      EXPECT_TRUE(std::isfinite(x)) << name;
      EXPECT_GE(x, table.lower()) << name;
      EXPECT_LE(x, Upper(table)) << name;
    }
}

TEST(MarginalTable, StandardLawsHaveTheirMoments) {
  EXPECT_NEAR(MarginalTable::Normal().Mean(), 0.0, 1e-12);
  EXPECT_NEAR(MarginalTable::Normal().Variance(), 1.0, kStep * kStep / 3.0);  // linear interpolation adds h^2 / 6
  EXPECT_NEAR(MarginalTable::StudentT(5.0).Variance(), 5.0 / 3.0, 0.05);      // cut at 16
  EXPECT_NEAR(MarginalTable::Uniform(2.0).Variance(), 4.0 / 3.0, 1e-12);
  EXPECT_GE(Upper(MarginalTable::Uniform(1.7320508)), 1.7320508);
}

TEST(MarginalTable, BoundsFarFromEverythingAreAsFarAsItReaches) {
  // As of a prior of a picometre within metres.
  for (const double far : {1e3, 1e9, 1e12, 1e300})
    EXPECT_DOUBLE_EQ(MarginalTable::Uniform(far).Variance(), MarginalTable::Uniform(16.0).Variance()) << far;
}

}  // namespace
}  // namespace armcmc::marginal_table_test
