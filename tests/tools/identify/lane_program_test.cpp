#include "armcmc/identify/lane_program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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

constexpr Varies kLane = Varies::kByLane, kSample = Varies::kBySample, kBoth = Varies::kByBoth;

/// Every lane of a text has, sample by sample, what the program of packs has for it alone, however many samples are
/// evaluated at once.
/// @param before  What the graph holds already, and so is computed first.
void ExpectTheSame(const std::string& text, const std::vector<Varies>& varies = {kBoth, kBoth, kLane},
                   const std::string& before = "t") {
  constexpr std::size_t kSamples = 40, kSecondRun = 25;
  Graph graph;
  static_cast<void>(graph.Lower(expression::Parse(before), test::PlantWords(), {}));
  const int node = graph.Lower(expression::Parse(text), test::PlantWords(), {});
  const LaneProgram lanes(graph, {node}, varies);
  const expression::FeatureProgram one(graph, {node});
  const auto signal = [&](std::size_t n, std::size_t lane, std::size_t s) {
    return Signals(varies[s] == kLane ? 0 : n, varies[s] == kSample ? 0 : lane)[s];
  };
  std::vector<Lanes> fixed(3);
  for (std::size_t l = 0; l < kLanes; ++l)
    for (std::size_t s = 0; s < 3; ++s) fixed[s][l] = varies[s] == kLane ? signal(0, l, s) : std::nan("");
  LaneRun run = lanes.Begin(fixed.data(), kDt);
  std::vector<std::unique_ptr<expression::FeatureMemory>> memories;
  for (std::size_t l = 0; l < kLanes; ++l) memories.push_back(std::make_unique<expression::FeatureMemory>());
  std::size_t samples = 1;
  for (std::size_t first = 0; first < kSamples; first += samples) {
    samples = std::min({samples % kTile + 1, kSamples - first, first < kSecondRun ? kSecondRun - first : kSamples});
    if (first == kSecondRun) run.Clear();
    std::vector<Lanes> input(3 * kTile), out(kTile);
    std::vector<double> t;
    for (std::size_t r = 0; r < samples; ++r) {
      t.push_back(kDt * static_cast<double>(first + r));
      for (std::size_t l = 0; l < kLanes; ++l)
        for (std::size_t s = 0; s < 3; ++s)
          input[s * kTile + r][l] = varies[s] == kLane ? std::nan("") : signal(first + r, l, s);
    }
    lanes.Evaluate(samples, input.data(), kTile, t.data(), &run, out.data());
    for (std::size_t r = 0; r < samples; ++r)
      for (std::size_t l = 0; l < kLanes; ++l) {
        if (first == kSecondRun && r == 0) memories[l]->Clear();
        const double mine[] = {signal(first + r, l, 0), signal(first + r, l, 1), signal(first + r, l, 2)};
        double expected = 0.0;
        one.Evaluate({mine, t[r], kDt}, memories[l].get(), &expected);
        // Delays are counted from the other end, which rounds otherwise.
        const double tolerance = std::isnan(expected) ? 0.0 : 1e-13 * (1.0 + std::fabs(expected));
        EXPECT_THAT(out[r][l], testing::NanSensitiveDoubleNear(expected, tolerance))
            << text << ": lane " << l << ", sample " << first + r << " of " << samples << " at once";
      }
  }
}

TEST(LaneProgram, EveryLaneHasWhatTheProgramOfPacksHas) {
  for (const char* text :
       {"x + v*u - 2", "-x/u", "sqrt(abs(x)) + exp(u) - log(u)", "if(v > 0 and not (x >= 0.5), x^2, sign(v))",
        "clamp(x, -0.5, u) + min(x, v)*max(u, 0)", "tanh(x) + sin(v)*cos(t) + atan(u)", "x^3 - 2*x^5 + v^4",
        "abs(x)^1.5 + abs(v)^0.5 + abs(u)^2.7", "abs(x)^u + abs(v)^-2", "clamp(log(-1 - x*x), u, 1)",
        "step(log(-1 - x*x))", "min(u, log(-1 - x*x))", "step(x) + (x != v) + (x == x)", "3", "2*u + exp(u*u)"})
    ExpectTheSame(text);
}

TEST(LaneProgram, FunctionsWithMemoryTakeTimeConstantsThatDifferByLane) {
  for (const char* text :
       {"lowpass(x, u)", "delay(x, u)", "delay(x, u/10)", "integral(v)*u", "previous(x)", "elapsed() + u",
        "lowpass(delay(v, u), 0.1) + integral(previous(x))", "delay(x, 0-u)", "lowpass(x, 0)", "lowpass(x, 0-u)"})
    ExpectTheSame(text);
}

TEST(LaneProgram, ATimeConstantMayChangeFromSampleToSample) {
  ExpectTheSame("lowpass(x, 0.1 + abs(v))");
  ExpectTheSame("lowpass(x, u)", {kBoth, kBoth, kBoth});
  ExpectTheSame("delay(x, 0.1 + abs(v))");
}

TEST(LaneProgram, WhatLanesShareIsComputedOnce) {
  ExpectTheSame("sin(x)*v + u", {kSample, kSample, kLane});
  ExpectTheSame("lowpass(sin(x), 0.2)", {kSample, kSample, kSample});
  ExpectTheSame("lowpass(sin(x), u)", {kSample, kSample, kLane});
  ExpectTheSame("x + u*v", {kLane, kSample, kLane});
}

TEST(LaneProgram, ABranchThatNoCandidateTakesChangesNothing) {
  for (const char* text :
       {"if(x > 0, sqrt(abs(v)), v*u)", "if(x > 0, v*u, v - u) + v*u", "if(x > 0, if(x > 0.5, v^2, v*u), v^2) - u",
        "if(x > 0, lowpass(v, u), integral(v + u))", "if(x > 0, v*u, exp(v*u))", "if(v > 0, v*u, if(x > 0, v, u - v))",
        "if(if(x > 0, x > 0.5, v > 0), v + u, v*u)"})
    ExpectTheSame(text, {kSample, kBoth, kLane});
}

TEST(LaneProgram, ABranchThatIsComputedBeforeItsConditionIsOfTheSameSample) {
  for (const char* text : {"if(x > 0, v*u, v - u)", "if(x > 0, v*u, 0)", "if(x > 0, 0, u - v)"})
    ExpectTheSame(text, {kSample, kBoth, kLane}, "v*u + (v - u)*(u - v)");
  ExpectTheSame("if(x > 0, v, 0)", {kSample, kSample, kSample}, "v");
}

TEST(LaneProgram, TwiceAsManyCandidatesAtOnceAreEachAsAlone) {
  Graph graph;
  const int node = graph.Lower(expression::Parse("if(x > 0, v*u, sqrt(abs(v)) + t) - exp(u)"), test::PlantWords(), {});
  const LaneProgram program(graph, {node}, {kSample, kBoth, kLane});
  std::array<std::vector<Lanes>, 2> alone{std::vector<Lanes>(3), std::vector<Lanes>(3)};
  std::vector<Lanes> both(6);
  const auto fill = [&](std::size_t n) {
    for (std::size_t h = 0; h < 2; ++h)
      for (std::size_t l = 0; l < kLanes; ++l)
        for (std::size_t s = 0; s < 3; ++s)
          both[2 * s + h][l] = alone[h][s][l] = Signals(s == 2 ? 0 : n, s == 0 ? 0 : h * kLanes + l)[s];
  };
  fill(0);
  LaneRun first = program.Begin(alone[0].data(), kDt), second = program.Begin(alone[1].data(), kDt);
  LaneRun pair = program.BeginPair(both.data(), kDt);
  for (std::size_t n = 0; n < 60; ++n) {
    fill(n);
    const double t = kDt * static_cast<double>(n);
    Lanes of_first, of_second;
    std::array<Lanes, 2> of_pair;
    program.Evaluate(1, alone[0].data(), 1, &t, &first, &of_first);
    program.Evaluate(1, alone[1].data(), 1, &t, &second, &of_second);
    program.EvaluatePair(both.data(), t, &pair, of_pair.data());
    EXPECT_EQ(of_pair[0], of_first) << n;
    EXPECT_EQ(of_pair[1], of_second) << n;
  }
}

TEST(LaneProgram, KnowsWhichSignalsItReadsSampleBySample) {
  Graph graph;
  const int node = graph.Lower(expression::Parse("x*u + t"), test::PlantWords(), {});
  const LaneProgram program(graph, {node}, {kSample, kSample, kLane});
  EXPECT_TRUE(program.Reads(0));
  EXPECT_FALSE(program.Reads(1));
  EXPECT_FALSE(program.Reads(2)) << "once a run";
}

TEST(LaneProgram, ADelayReachesBackToTheBeginningOfTheRun) {
  Graph graph;
  const int node = graph.Lower(expression::Parse("delay(x, u)"), test::PlantWords(), {});
  const LaneProgram program(graph, {node}, {kBoth, kBoth, kLane});
  std::vector<Lanes> input(3, Lanes{});
  input[2].fill(2000.0 * kDt);
  LaneRun run = program.Begin(input.data(), kDt);
  constexpr int kSamples = 3000;  // more than a line of the estimator holds
  for (int n = 0; n < kSamples; ++n) {
    input[0].fill(static_cast<double>(n));
    const double t = n * kDt;
    Lanes out;
    program.Evaluate(1, input.data(), 1, &t, &run, &out);
    EXPECT_NEAR(out[3], std::max(0, n - 2000), 1e-6);
  }
}

}  // namespace
}  // namespace armcmc::identify::lane_program_test
