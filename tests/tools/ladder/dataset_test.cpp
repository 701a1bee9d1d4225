#include "armcmc/ladder/dataset.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tools/ladder/made_data.hpp"

namespace armcmc::ladder::dataset_test {
namespace {

/// Two runs of 600 and 400 rows whose signal is the row; the last 100 rows are kept apart.
Dataset Rows() {
  auto series = std::make_shared<identify::Series>();
  series->dt = 0.1;
  series->runs = {0, 600};
  series->signals.resize(1);
  Dataset data;
  for (int n = 0; n < 1000; ++n) {
    series->t.push_back(0.1 * (n < 600 ? n : n - 600));
    series->signals[0].push_back(n);
    data.training.push_back(n < 900 ? 1 : 0);
    data.held_out.push_back(n < 900 ? 0 : 1);
  }
  data.series = std::move(series);
  return data;
}

TEST(Dataset, BeginningsAreThoseOfEveryRunAndHoldNothingBack) {
  const Dataset part = Beginnings(Rows(), 90);
  EXPECT_EQ(part.series->runs, (std::vector<std::size_t>{0, 60}));
  ASSERT_EQ(part.series->num_rows(), 90u);
  EXPECT_EQ(part.series->signals[0][59], 59.0);
  EXPECT_EQ(part.series->signals[0][60], 600.0);
  EXPECT_EQ(part.num_training(), 90u);
  // All of it: up to the last training row.
  EXPECT_EQ(Beginnings(Rows(), 5000).series->num_rows(), 900u);
}

TEST(Dataset, WindowsAreWhereErrorsAreAndElsewhere) {
  const Dataset all = Rows();
  Eigen::VectorXd error = Eigen::VectorXd::Zero(1000);
  error.segment(430, 20).setConstant(5.0);
  error.segment(950, 20).setConstant(50.0);  // kept apart: not looked at
  const Dataset part = Windows(all, error, 50, 200);
  std::vector<double> firsts;
  for (const std::size_t run : part.series->runs) firsts.push_back(part.series->signals[0][run]);
  EXPECT_EQ(part.series->num_rows(), 200u);
  EXPECT_NE(std::find(firsts.begin(), firsts.end(), 400.0), firsts.end());
  EXPECT_EQ(firsts.front(), 0.0);
  EXPECT_EQ(std::count(part.training.begin(), part.training.end(), 1), 150);
}

TEST(Dataset, AWindowThatMeetsTheEndOfARunIsTwo) {
  Dataset all = Rows();
  Eigen::VectorXd error = Eigen::VectorXd::Zero(1000);
  error.segment(570, 60).setConstant(5.0);
  const Dataset part = Windows(all, error, 100, 400);
  for (std::size_t n = 0; n < part.series->num_rows(); ++n)
    if (part.series->signals[0][n] == 600.0) {
      EXPECT_NE(std::find(part.series->runs.begin(), part.series->runs.end(), n), part.series->runs.end());
    }
}

TEST(Dataset, TheNoiseFloorIsTheNoiseWhereTheSignalIsSmooth) {
  const Dataset data = test::AxisData([](const test::AxisSample& s) { return 40.0 * s.q; });
  const std::vector<double>& force = data.series->signals[3];
  const Eigen::VectorXd target = Eigen::Map<const Eigen::VectorXd>(force.data(), 2000);
  EXPECT_NEAR(NoiseFloor(data, target, std::vector<std::uint8_t>(2000, 1)), 2.0, 0.15);
}

}  // namespace
}  // namespace armcmc::ladder::dataset_test
