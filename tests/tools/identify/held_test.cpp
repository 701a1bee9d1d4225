// Whole recordings with a command that is held between samples.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/identify/trajectory_model.hpp"

namespace armcmc::test::held_test {
namespace {

using identify::Series;
using identify::TrajectoryModel;

constexpr double kDt = 0.01, kTau = 0.03;
constexpr int kRows = 200;

double Command(int n) { return n % 23 < 11 ? 1.0 + 0.01 * n : -0.5; }

Eigen::VectorXd Predicted(const std::string& law, const std::string& rate) {
  PlantDescription plant;
  plant.name = "late";
  plant.output = "y";
  plant.law = law;
  plant.signals = {{"u", "1", "drive", ""}, {"y", "1", "position", ""}};
  plant.signals[0].between = "held";
  plant.parameters = {{"tau", "s", "normal", kTau, 0.01, 0.001, 1.0}};
  plant.constants = {{"w", 1.0, "s"}};
  if (!rate.empty()) plant.states = {{"T", "1", "", rate, "u", "", 20}};
  const auto series = std::make_shared<Series>();
  series->dt = kDt;
  series->runs = {0};
  series->signals.resize(2);
  for (int n = 0; n < kRows; ++n) {
    series->t.push_back(kDt * n);
    series->signals[0].push_back(Command(n));
    series->signals[1].push_back(0.0);
  }
  Eigen::VectorXd prediction;
  EXPECT_TRUE(TrajectoryModel(std::make_shared<const Plant>(plant), series)
                  .PredictOne(Eigen::VectorXd::Constant(1, kTau), &prediction));
  return prediction;
}

/// A low pass of a command that is held and comes `late` samples later.
std::vector<double> Lowpass(double late) {
  const int whole = static_cast<int>(late);
  const double part = late - whole, decay = std::exp(-kDt / kTau);
  const auto at = [](int n) { return Command(std::max(n, 0)); };
  std::vector<double> y{Command(0)};
  for (int n = 1; n < kRows; ++n)
    y.push_back(y.back() * decay + (1.0 - decay) * (part * at(n - 2 - whole) + (1.0 - part) * at(n - 1 - whole)));
  return y;
}

void ExpectRows(const Eigen::VectorXd& got, const std::vector<double>& expected, double near) {
  ASSERT_EQ(got.size(), kRows);
  for (int n = 0; n < kRows; ++n) ASSERT_NEAR(got[n], expected[static_cast<std::size_t>(n)], near) << n;
}

TEST(Held, LowPassesAndRatesTakeItAsHeld) {
  ExpectRows(Predicted("lowpass(u, tau)", ""), Lowpass(0.0), 1e-12);
  ExpectRows(Predicted("lowpass(delay(u, 0.024), tau)", ""), Lowpass(2.4), 1e-12);
  ExpectRows(Predicted("T", "(u - T)/tau"), Lowpass(0.0), 1e-7);
  ExpectRows(Predicted("T", "(delay(u, 0.024) - T)/tau"), Lowpass(2.4), 1e-7);
}

TEST(Held, ADelayAtASampleIsWhatWasHeldThen) {
  std::vector<double> step, mean;
  for (int n = 0; n < kRows; ++n) {
    step.push_back(Command(std::max(n - 3, 0)));
    // tau is three samples: three and a half, linear.
    mean.push_back(0.5 * (Command(std::max(n - 3, 0)) + Command(std::max(n - 4, 0))));
  }
  ExpectRows(Predicted("delay(u, 0.024) + 1e-300*tau/w", ""), step, 1e-12);
  ExpectRows(Predicted("delay(u, tau)", ""), mean, 1e-9);
}

}  // namespace
}  // namespace armcmc::test::held_test
