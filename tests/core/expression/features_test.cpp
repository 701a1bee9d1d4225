#include "armcmc/expression/features.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/expression/plant_words.hpp"

namespace armcmc::features_test {
namespace {

using expression::FeatureMemory;
using expression::FeatureProgram;
using expression::Graph;

/// Values of a text for x = the given samples, v = 2 x.
std::vector<double> Filtered(const std::string& text, const std::vector<double>& x, double dt) {
  Graph graph;
  const expression::Scope scope = test::PlantWords();
  const int node = graph.Lower(expression::Parse(text), scope, {});
  const FeatureProgram program(graph, {node});
  auto memory = std::make_unique<FeatureMemory>();
  std::vector<double> values;
  for (std::size_t n = 0; n < x.size(); ++n) {
    const double signals[] = {x[n], 2.0 * x[n], 0.0};
    double value = 0.0;
    program.Evaluate({signals, static_cast<double>(n) * dt, dt}, memory.get(), &value);
    values.push_back(value);
  }
  return values;
}

std::vector<double> Ramp(int samples, double dt) {
  std::vector<double> x;
  x.reserve(static_cast<std::size_t>(samples));
  for (int n = 0; n < samples; ++n) x.push_back(n * dt);
  return x;
}

TEST(Features, LowPassOfARampIsExact) {
  // x = t: y = t - tau (1 - exp(-t / tau)).
  for (const double dt : {0.01, 0.3}) {
    const auto y = Filtered("lowpass(x, 0.2)", Ramp(20, dt), dt);
    for (std::size_t n = 0; n < y.size(); ++n) {
      const double t = static_cast<double>(n) * dt;
      EXPECT_NEAR(y[n], t - 0.2 * (1.0 - std::exp(-t / 0.2)), 1e-14);
    }
  }
}

TEST(Features, LowPassOfExtremeTimeConstants) {
  const std::vector<double> x{1.0, 2.0, -3.0};
  EXPECT_EQ(Filtered("lowpass(x, 0)", x, 0.1), x);
  EXPECT_EQ(Filtered("lowpass(x, -1)", x, 0.1), x);
  for (const double y : Filtered("lowpass(x, 1e30)", x, 0.1)) EXPECT_NEAR(y, 1.0, 1e-12);
}

TEST(Features, DelayIsLinearBetweenSamples) {
  const std::vector<double> x{0.0, 1.0, 4.0, 9.0, 16.0};
  EXPECT_EQ(Filtered("delay(x, 0.2)", x, 0.1), (std::vector<double>{0.0, 0.0, 0.0, 1.0, 4.0}));
  const auto between = Filtered("delay(x, 0.15)", x, 0.1);
  const std::vector<double> expected{0.0, 0.0, 0.5, 2.5, 6.5};
  for (std::size_t n = 0; n < x.size(); ++n) EXPECT_NEAR(between[n], expected[n], 1e-12);
}

TEST(Features, DelayReachesBackOverTheWholeLine) {
  const auto y = Filtered("delay(x, 10)", Ramp(4000, 0.01), 0.01);
  for (std::size_t n = 1000; n < y.size(); ++n) ASSERT_NEAR(y[n], static_cast<double>(n) * 0.01 - 10.0, 1e-9);
}

TEST(Features, DelayThatIsLongerThanTheLineHasNoValue) {
  const auto y = Filtered("delay(x, 12)", Ramp(1200, 0.01), 0.01);
  EXPECT_EQ(y[1000], 0.0) << "the first sample, as long as it is remembered";
  EXPECT_TRUE(std::isnan(y[1199])) << "never a shorter delay in its place";
}

TEST(Features, IntegralPreviousAndElapsed) {
  const std::vector<double> x{1.0, 2.0, 4.0};
  const auto integral = Filtered("integral(x)", x, 0.5);
  EXPECT_EQ(integral, (std::vector<double>{0.0, 0.75, 2.25}));
  EXPECT_EQ(Filtered("previous(x)", x, 0.5), (std::vector<double>{1.0, 1.0, 2.0}));
  EXPECT_EQ(Filtered("elapsed()", x, 0.5), (std::vector<double>{0.0, 0.5, 1.0}));
  EXPECT_EQ(Filtered("integral(2)", x, 0.5), (std::vector<double>{0.0, 1.0, 2.0}));
  EXPECT_EQ(Filtered("t + v", x, 0.5), (std::vector<double>{2.0, 4.5, 9.0}));
}

TEST(Features, MemoryOfMemory) {
  // Two equal low passes in a row of a step have a closed form: 1 - (1 + t / tau) exp(-t / tau); the first is no longer
  // linear between samples, so that short ones are needed.
  const double dt = 1e-4;
  std::vector<double> x(5001, 1.0);
  x[0] = 0.0;
  const auto y = Filtered("lowpass(lowpass(x, 0.1), 0.1)", x, dt);
  const double t = 5000 * dt;
  EXPECT_NEAR(y.back(), 1.0 - (1.0 + t / 0.1) * std::exp(-t / 0.1), 1e-4);
}

TEST(Features, ClearedMemoryStartsAgain) {
  Graph graph;
  const int node = graph.Lower(expression::Parse("integral(x) + delay(x, 1) + elapsed()"), test::PlantWords(), {});
  const FeatureProgram program(graph, {node});
  auto memory = std::make_unique<FeatureMemory>();
  const auto run = [&] {
    double value = 0.0;
    for (int n = 0; n < 5; ++n) {
      const double signals[] = {1.0 + n, 0.0, 0.0};
      program.Evaluate({signals, n * 0.1, 0.1}, memory.get(), &value);
    }
    return value;
  };
  const double once = run();
  EXPECT_NE(run(), once);
  memory->Clear();
  EXPECT_EQ(run(), once);
}

}  // namespace
}  // namespace armcmc::features_test
