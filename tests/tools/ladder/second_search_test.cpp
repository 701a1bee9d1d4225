#include "armcmc/ladder/second_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "armcmc/gap/recording.hpp"
#include "armcmc/models/registry.hpp"

namespace armcmc::test::second_search_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Presses of several depths and speeds into something soft, 10 s at 200 Hz; the sensor adds `offset`.
gap::WorkflowRequest Presses(double offset) {
  gap::WorkflowRequest request;
  request.model = DefaultModel();
  constexpr int kRows = 2000;
  gap::Recording& data = request.data;
  data.source = "presses.csv";
  data.dt = 0.005;
  data.t.resize(kRows);
  data.names = {"x", "v", "f"};
  data.columns.assign(3, gap::Vector(kRows));
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 0.02);
  for (int n = 0; n < kRows; ++n) {
    const double t = data.dt * n;
    const double x = 0.6 + 0.9 * std::sin(3.1 * t) + 0.4 * std::sin(7.7 * t + 1.0);
    const double v = 0.9 * 3.1 * std::cos(3.1 * t) + 0.4 * 7.7 * std::cos(7.7 * t + 1.0);
    data.t[n] = t;
    data.columns[0][n] = x;
    data.columns[1][n] = v;
    data.columns[2][n] = (x > 0.0 ? std::pow(x, 1.4) * (2.0 + 0.3 * v) : 0.0) + offset + noise(random);
  }
  return request;
}

TEST(SecondSearch, NamesByTheCompiledPlantsNames) {
  const auto found = ladder::SearchAgain(Presses(0.3));
  ASSERT_TRUE(found);
  const gap::Result& result = found->diagnosis.result;
  ASSERT_EQ(result.effects.size(), 1U);
  EXPECT_EQ(result.effects[0].name, "force_bias");
  ASSERT_EQ(result.ladder.size(), 1U);
  EXPECT_THAT(result.ladder[0].effects, ElementsAre("force_bias"));
  EXPECT_THAT(result.sentence, HasSubstr("Missing: force bias."));
  EXPECT_EQ(result.model, DefaultModel());
  EXPECT_NEAR(result.effects[0].parameters.at(0).mean, 0.3, 0.01);
  // The last 30 % were kept apart.
  EXPECT_NEAR(result.gap.after.rmse, 0.02, 0.002);
  EXPECT_EQ(found->recording.num_rows(), 2000U);
  EXPECT_EQ(found->recording.held_out[1399], 0);
  EXPECT_EQ(found->recording.held_out[1400], 1);
}

TEST(SecondSearch, NamesNothingWhereNothingIsHidden) { EXPECT_FALSE(ladder::SearchAgain(Presses(0.0))); }

TEST(SecondSearch, IsNotMadeWhereItCannotAnswer) {
  const gap::WorkflowRequest asked = Presses(0.3);
  gap::WorkflowRequest request = asked;
  request.heldout = asked.data;
  EXPECT_FALSE(ladder::SearchAgain(request)) << "data of another file are to be judged on";
  request = asked;
  request.earlier = asked.data;
  EXPECT_FALSE(ladder::SearchAgain(request)) << "two recordings";
  request = asked;
  request.until = gap::Step::kName;
  EXPECT_FALSE(ladder::SearchAgain(request)) << "stops before the end";
  request = asked;
  request.diagnose.known.emplace_back("inertia", gap::When{});
  EXPECT_FALSE(ladder::SearchAgain(request)) << "a model with effects";
  request = asked;
  request.data.names[1] = "speed";
  EXPECT_FALSE(ladder::SearchAgain(request)) << "a signal of the plant is not there";
  request = asked;
  request.diagnose.without = {"force_bias"};
  if (const auto found = ladder::SearchAgain(request)) {
    EXPECT_NE(found->diagnosis.result.effects[0].name, "force_bias");
  }
}

}  // namespace
}  // namespace armcmc::test::second_search_test
