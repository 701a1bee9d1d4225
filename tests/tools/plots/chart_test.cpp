#include "armcmc/plots/chart.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace armcmc::plots::chart_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using nlohmann::json;

XyChart ChartOf(std::vector<double> x, std::vector<double> y) {
  XyChart chart;
  chart.series.push_back({"curve", Role::kBefore, std::move(x), std::move(y), {}, {}});
  return chart;
}

TEST(XyChart, TurnsWhatIsNotFiniteIntoGaps) {
  const json spec = ToJson(ChartOf({0.0, 1.0, 2.0, 3.0}, {1.0, std::nan(""), kInfinity, 4.0}));
  EXPECT_EQ(spec["series"][0]["y"], (json{1.0, nullptr, nullptr, 4.0}));
}

TEST(XyChart, DropsSamplesWithoutX) {
  const json spec = ToJson(ChartOf({0.0, std::nan(""), 2.0}, {1.0, 2.0, 3.0}));
  EXPECT_EQ(spec["series"][0]["x"], (json{0.0, 2.0}));
  EXPECT_EQ(spec["series"][0]["y"], (json{1.0, 3.0}));
}

TEST(XyChart, SortsByX) {
  const json spec = ToJson(ChartOf({2.0, 0.0, 1.0}, {20.0, 0.0, 10.0}));
  EXPECT_EQ(spec["series"][0]["y"], (json{0.0, 10.0, 20.0}));
}

TEST(XyChart, HasNoPlaceForZeroOnALogarithmicAxis) {
  XyChart chart = ChartOf({0.0, 1.0, 10.0}, {5.0, 0.0, -3.0});
  chart.log_x = chart.log_y = true;
  const json spec = ToJson(chart);
  EXPECT_EQ(spec["series"][0]["x"], (json{1.0, 10.0}));
  EXPECT_EQ(spec["series"][0]["y"], (json{nullptr, nullptr}));
  EXPECT_FALSE(HasData(chart));
}

TEST(XyChart, KeepsNeighboursOfALongRecordingApart) {
  const json spec = ToJson(ChartOf({86'400.001, 86'400.002}, {0.0, 0.0}));
  EXPECT_LT(spec["series"][0]["x"][0].get<double>(), spec["series"][0]["x"][1].get<double>());
}

TEST(XyChart, StaysSmallForManySamples) {
  std::vector<double> x(200'000), y(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = 1e-3 * static_cast<double>(i), y[i] = std::sin(x[i]);
  EXPECT_LT(ToJson(ChartOf(x, y)).dump().size(), 100'000u);
}

TEST(XyChart, RefusesLengthsThatDoNotFit) {
  EXPECT_THROW((void)ToJson(ChartOf({0.0, 1.0}, {0.0})), std::invalid_argument);
  XyChart chart = ChartOf({0.0, 1.0}, {0.0, 1.0});
  chart.series[0].low = {0.0, 0.0};
  EXPECT_THROW((void)ToJson(chart), std::invalid_argument);
}

TEST(XyChart, KnowsWhenThereIsNothingToDraw) {
  EXPECT_FALSE(HasData(XyChart{}));
  EXPECT_FALSE(HasData(ChartOf({0.0, 1.0}, {std::nan(""), kInfinity})));
  EXPECT_TRUE(HasData(ChartOf({0.0, 1.0}, {std::nan(""), 0.0})));
}

HeatMap MapOf(std::vector<double> x_edges, std::vector<double> y_edges, std::vector<double> value) {
  HeatMap map;
  map.x_edges = std::move(x_edges), map.y_edges = std::move(y_edges), map.value = std::move(value);
  return map;
}

TEST(HeatMap, WritesNullWhereThereAreNoData) {
  EXPECT_EQ(ToJson(MapOf({0.0, 1.0, 2.0}, {0.0, 1.0}, {0.25, std::nan("")}))["value"], (json{0.25, nullptr}));
}

TEST(HeatMap, RefusesWhatDoesNotFit) {
  EXPECT_THROW((void)ToJson(MapOf({0.0, 1.0, 2.0}, {0.0, 1.0}, {1.0})), std::invalid_argument);
  EXPECT_THROW((void)ToJson(MapOf({0.0, 1.0, 1.0}, {0.0, 1.0}, {1.0, 2.0})), std::invalid_argument);
  EXPECT_THROW((void)ToJson(MapOf({0.0, std::nan("")}, {0.0, 1.0}, {1.0})), std::invalid_argument);
}

}  // namespace
}  // namespace armcmc::plots::chart_test
