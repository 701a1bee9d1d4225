#include "armcmc/identify/lane_program.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/expression/features.hpp"
#include "armcmc/expression/syntax.hpp"
#include "core/expression/plant_words.hpp"

namespace armcmc::identify::lane_program_test {
namespace {

using expression::Graph;

constexpr double kDt = 0.05;

/// Signals x, v, u of lane l at sample n.
std::vector<double> Signals(std::size_t n, std::size_t lane) {
  const double t = kDt * static_cast<double>(n), phase = 0.3 * static_cast<double>(lane);
  return {std::sin(3.0 * t + phase), 3.0 * std::cos(3.0 * t + phase), 0.2 + 0.05 * static_cast<double>(lane)};
}

/// Every lane of a text has, sample by sample, what the program of packs has for it alone.
void ExpectTheSame(const std::string& text, const std::vector<std::uint8_t>& shared = {0, 0, 0}) {
  constexpr std::size_t kSamples = 40, kSecondRun = 25;
  Graph graph;
  const int node = graph.Lower(expression::Parse(text), test::PlantWords(), {});
  const LaneProgram lanes(graph, {node}, shared);
  const expression::FeatureProgram one(graph, {node});
  LaneMemory memory = lanes.Memory();
  std::vector<std::unique_ptr<expression::FeatureMemory>> memories;
  for (std::size_t l = 0; l < kLanes; ++l) memories.push_back(std::make_unique<expression::FeatureMemory>());
  for (std::size_t n = 0; n < kSamples; ++n) {
    const double t = kDt * static_cast<double>(n);
    std::vector<Lanes> input(3);
    for (std::size_t l = 0; l < kLanes; ++l)
      for (std::size_t s = 0; s < 3; ++s) input[s][l] = Signals(n, shared[s] != 0 ? 0 : l)[s];
    if (n == kSecondRun) memory.Clear();
    Lanes out;
    lanes.Evaluate(input.data(), t, kDt, &memory, &out);
    for (std::size_t l = 0; l < kLanes; ++l) {
      if (n == kSecondRun) memories[l]->Clear();
      const double mine[] = {input[0][l], input[1][l], input[2][l]};
      double expected = 0.0;
      one.Evaluate({mine, t, kDt}, memories[l].get(), &expected);
      // Delays are counted from the other end, which rounds otherwise.
      EXPECT_NEAR(out[l], expected, 1e-13 * (1.0 + std::fabs(expected)))
          << text << ": lane " << l << ", sample " << n << ": " << out[l] << " for " << expected;
    }
  }
}

TEST(LaneProgram, EveryLaneHasWhatTheProgramOfPacksHas) {
  for (const char* text : {"x + v*u - 2", "-x/u", "sqrt(abs(x)) + exp(u) - log(u)",
                           "if(v > 0 and not (x >= 0.5), x^2, sign(v))", "clamp(x, -0.5, u) + min(x, v)*max(u, 0)",
                           "tanh(x) + sin(v)*cos(t) + atan(u)", "step(x) + (x != v) + (x == x)"})
    ExpectTheSame(text);
}

TEST(LaneProgram, FunctionsWithMemoryTakeTimeConstantsThatDifferByLane) {
  for (const char* text : {"lowpass(x, u)", "delay(x, u)", "delay(x, u/10)", "integral(v)*u", "previous(x)",
                           "elapsed() + u", "lowpass(delay(v, u), 0.1) + integral(previous(x))", "delay(x, 0-u)"})
    ExpectTheSame(text);
}

TEST(LaneProgram, WhatLanesShareIsComputedOnce) {
  ExpectTheSame("sin(x)*v + u", {1, 1, 0});
  ExpectTheSame("lowpass(sin(x), 0.2)", {1, 1, 1});
  ExpectTheSame("lowpass(sin(x), u)", {1, 1, 0});
}

TEST(LaneProgram, ADelayReachesBackToTheBeginningOfTheRun) {
  Graph graph;
  const int node = graph.Lower(expression::Parse("delay(x, u)"), test::PlantWords(), {});
  const LaneProgram program(graph, {node}, {0, 0, 0});
  LaneMemory memory = program.Memory();
  constexpr int kSamples = 3000;  // more than a line of the estimator holds
  for (int n = 0; n < kSamples; ++n) {
    std::vector<Lanes> input(3, Lanes{});
    input[0].fill(static_cast<double>(n));
    input[2].fill(2000.0 * kDt);
    Lanes out;
    program.Evaluate(input.data(), n * kDt, kDt, &memory, &out);
    EXPECT_NEAR(out[3], std::max(0, n - 2000), 1e-6);
  }
}

}  // namespace
}  // namespace armcmc::identify::lane_program_test
