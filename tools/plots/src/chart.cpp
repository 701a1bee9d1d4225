#include "armcmc/plots/chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <stdexcept>

#include "armcmc/plots/decimate.hpp"
#include "armcmc/plots/html.hpp"

namespace armcmc::plots {
namespace {

using nlohmann::json;

/// Twice the pixels of a wide screen: as much as a curve can show.
constexpr std::size_t kMaxPoints = 4000;

json Rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  char text[40];
  std::snprintf(text, sizeof(text), "%.*g", digits, value);
  return std::strtod(text, nullptr);
}

json RoundedAll(const std::vector<double>& values, const std::vector<std::size_t>& which, bool log, int digits) {
  json out = json::array();
  for (const std::size_t i : which) out.push_back(log && values[i] <= 0.0 ? json() : Rounded(values[i], digits));
  return out;
}

const char* Name(Role role) {
  switch (role) {
    case Role::kMeasured: return "measured";
    case Role::kBefore: return "before";
    case Role::kAfter: return "after";
    case Role::kEffect: return "effect";
    case Role::kOther: break;
  }
  return "other";
}

void CheckLengths(const Series& s) {
  const bool band = !s.low.empty() || !s.high.empty();
  if (s.x.size() != s.y.size() || (band && (s.low.size() != s.y.size() || s.high.size() != s.y.size())))
    throw std::invalid_argument("series '" + s.label + "': x, y and the band must have one length");
}

bool Drawable(double value, bool log) { return std::isfinite(value) && (!log || value > 0.0); }

/// The samples with a usable x, ascending in x.
std::vector<std::size_t> Order(const std::vector<double>& x, bool log) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (Drawable(x[i], log)) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
  return order;
}

std::vector<double> Pick(const std::vector<double>& values, const std::vector<std::size_t>& which) {
  std::vector<double> out;
  if (values.empty()) return out;
  out.reserve(which.size());
  for (const std::size_t i : which) out.push_back(values[i]);
  return out;
}

json SeriesJson(const Series& s, const XyChart& chart) {
  CheckLengths(s);
  const std::vector<std::size_t> order = Order(s.x, chart.log_x);
  const std::vector<double> x = Pick(s.x, order), y = Pick(s.y, order), low = Pick(s.low, order),
                            high = Pick(s.high, order);
  const std::vector<std::size_t> kept = Decimate({&y, &low, &high}, kMaxPoints);
  json out = {{"label", ValidUtf8(s.label)}, {"role", Name(s.role)}};
  // More digits on x: neighbours of a long recording differ late.
  out["x"] = RoundedAll(x, kept, false, 9);
  out["y"] = RoundedAll(y, kept, chart.log_y, 5);
  if (!low.empty()) {
    out["low"] = RoundedAll(low, kept, chart.log_y, 5);
    out["high"] = RoundedAll(high, kept, chart.log_y, 5);
  }
  return out;
}

json AllOf(const std::vector<double>& values, int digits) {
  std::vector<std::size_t> all(values.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return RoundedAll(values, all, false, digits);
}

}  // namespace

bool HasData(const XyChart& chart) {
  return std::any_of(chart.series.begin(), chart.series.end(), [&](const Series& s) {
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i)
      if (Drawable(s.x[i], chart.log_x) && Drawable(s.y[i], chart.log_y)) return true;
    return false;
  });
}

bool HasData(const HeatMap& map) {
  return std::any_of(map.value.begin(), map.value.end(), [](double v) { return std::isfinite(v); });
}

json ToJson(const XyChart& chart) {
  json out = {{"x_title", ValidUtf8(chart.x_title)},
              {"y_title", ValidUtf8(chart.y_title)},
              {"log_x", chart.log_x},
              {"log_y", chart.log_y},
              {"sync", ValidUtf8(chart.sync)},
              {"height", chart.height}};
  out["series"] = json::array();
  for (const Series& s : chart.series)
    if (!s.x.empty()) out["series"].push_back(SeriesJson(s, chart));
  out["shades"] = json::array();
  for (const Shade& s : chart.shades)
    if (std::isfinite(s.from) && std::isfinite(s.to))
      out["shades"].push_back({{"from", s.from}, {"to", s.to}, {"label", ValidUtf8(s.label)}});
  out["rules"] = json::array();
  for (const Rule& r : chart.rules)
    if (Drawable(r.y, chart.log_y)) out["rules"].push_back({{"y", r.y}, {"label", ValidUtf8(r.label)}});
  return out;
}

json ToJson(const HeatMap& map) {
  const std::size_t columns = map.x_edges.empty() ? 0 : map.x_edges.size() - 1;
  const std::size_t rows = map.y_edges.empty() ? 0 : map.y_edges.size() - 1;
  if (map.value.size() != columns * rows)
    throw std::invalid_argument("heat map of '" + map.value_title + "': " + std::to_string(map.value.size()) +
                                " values for " + std::to_string(columns) + " x " + std::to_string(rows) + " cells");
  if (map.line_x.size() != map.line_y.size())
    throw std::invalid_argument("heat map of '" + map.value_title + "': the line needs as many x as y");
  const auto ascending = [](const std::vector<double>& edges) {
    return std::all_of(edges.begin(), edges.end(), [](double v) { return std::isfinite(v); }) &&
           std::adjacent_find(edges.begin(), edges.end(), std::greater_equal<>()) == edges.end();
  };
  if (!ascending(map.x_edges) || !ascending(map.y_edges))
    throw std::invalid_argument("heat map of '" + map.value_title + "': edges must be finite and ascending");
  return {{"x_title", ValidUtf8(map.x_title)},
          {"y_title", ValidUtf8(map.y_title)},
          {"value_title", ValidUtf8(map.value_title)},
          {"x_edges", AllOf(map.x_edges, 7)},
          {"y_edges", AllOf(map.y_edges, 7)},
          {"value", AllOf(map.value, 4)},
          {"line_x", AllOf(map.line_x, 6)},
          {"line_y", AllOf(map.line_y, 6)},
          {"height", map.height}};
}

}  // namespace armcmc::plots
