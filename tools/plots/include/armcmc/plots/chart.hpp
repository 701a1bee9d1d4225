#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace armcmc::plots {

/// What a curve stands for: fixes its colour and its dashes, which are the same in every chart of every page.
enum class Role { kMeasured, kBefore, kAfter, kEffect, kOther };

/// One curve. `low` and `high` (both or none) are the edges of a band around it. Values that are not finite are gaps.
struct Series {
  std::string label;
  Role role = Role::kOther;
  std::vector<double> x, y, low, high;
};

/// A part of the x axis with a tinted background.
struct Shade {
  double from = 0.0, to = 0.0;
  std::string label;
};

/// A straight line across the chart.
struct Rule {
  double y = 0.0;
  std::string label;
};

/// Curves over one axis. On a logarithmic axis values that are not positive are gaps.
struct XyChart {
  std::string x_title, y_title;  ///< With unit.
  std::vector<Series> series;
  std::vector<Shade> shades;
  std::vector<Rule> rules;
  bool log_x = false, log_y = false;
  std::string sync;  ///< Charts with the same word share cursor and zoom. Empty: alone.
  int height = 260;  ///< CSS pixels.
};

/// Coloured cells. `value` goes row by row of y; cells that are not finite are drawn as "no data".
struct HeatMap {
  std::string x_title, y_title, value_title;
  std::vector<double> x_edges, y_edges;  ///< Ascending.
  std::vector<double> value;             ///< (x_edges - 1) (y_edges - 1)
  int height = 320;                      ///< CSS pixels.
  std::vector<double> line_x{};          ///< Of a dashed line on top; may be empty.
  std::vector<double> line_y{};          ///< As many. Not finite: a gap.
};

/// Whether there is anything to draw.
[[nodiscard]] bool HasData(const XyChart& chart);
[[nodiscard]] bool HasData(const HeatMap& map);

/// Specification that the script of the page draws. Long curves are decimated, curves are sorted by x, numbers are
/// rounded to what a screen can show, and nothing in it is NaN or infinite.
/// @throws std::invalid_argument when lengths do not fit together, naming the curve.
[[nodiscard]] nlohmann::json ToJson(const XyChart& chart);
[[nodiscard]] nlohmann::json ToJson(const HeatMap& map);

}  // namespace armcmc::plots
