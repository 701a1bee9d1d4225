#include "figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "armcmc/sample_size.hpp"
#include "armcmc/tables/plants/registry.hpp"

namespace armcmc::tables {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct Quantity {
  const char* name;
  const char* unit;
  double lower, upper;  // of the density map
};
constexpr std::array<Quantity, 3> kQuantities{
    {{"K", "N/m^p", 0.0, 8.0}, {"B", "N s/m^(p+1)", 0.0, 8.0}, {"p", "", 1.0, 2.5}}};

double TimeOf(const Recording& r, std::size_t sample) { return static_cast<double>(sample) * r.dt; }

plots::Series TruthSeries(const Recording& r, std::size_t d) {
  plots::Series s{.label = "truth", .role = plots::Role::kEffect, .x = {}, .y = {}, .low = {}, .high = {}};
  for (std::size_t i = 0; i < r.size(); i += 10) {
    const bool acts = !kContact.Is(r.plant) || r.u[0][i] >= 0.0;
    s.x.push_back(TimeOf(r, i));
    s.y.push_back(acts ? r.truth[d][i] : kNone);
  }
  return s;
}

/// Density of parameter d of each pack over its own maximum, two packs a column.
void DensityMap(const Experiment& e, const Trace& trace, std::size_t d, plots::Page* page) {
  constexpr std::size_t kRows = 60;
  const std::size_t columns = trace.packs.size() / 2;
  const double step = 2.0 * trace.pack_samples * e.recording.dt;
  plots::HeatMap map;
  map.height = 240;
  map.x_title = "t, s";
  map.y_title =
      std::string(kQuantities[d].name) + (*kQuantities[d].unit != '\0' ? std::string(", ") + kQuantities[d].unit : "");
  map.value_title = "density / max";
  const double span = kQuantities[d].upper - kQuantities[d].lower;
  for (std::size_t c = 0; c <= columns; ++c) map.x_edges.push_back(step * static_cast<double>(c));
  for (std::size_t r = 0; r <= kRows; ++r)
    map.y_edges.push_back(kQuantities[d].lower + span * static_cast<double>(r) / static_cast<double>(kRows));
  map.value.assign(columns * kRows, kNone);
  for (std::size_t c = 0; c < columns; ++c) {
    const PackTrace& pack = trace.packs[2 * c + 1];
    if (!pack.modes[0].updated) continue;
    const MarginalSummary& m = pack.marginal[d];
    std::vector<double> mass(kRows, 0.0);
    const double width = (m.histogram_hi - m.histogram_lo) / kHistogramBins;
    for (std::size_t b = 0; b < m.density.size(); ++b) {
      const double at = m.histogram_lo + (static_cast<double>(b) + 0.5) * width;
      const double row = std::clamp((at - kQuantities[d].lower) / span, 0.0, 1.0 - 1e-9) * static_cast<double>(kRows);
      mass[static_cast<std::size_t>(row)] += m.density[b];
    }
    const double most = std::max(*std::max_element(mass.begin(), mass.end()), 1e-300);
    for (std::size_t r = 0; r < kRows; ++r) map.value[r * columns + c] = mass[r] / most;
  }
  const plots::Series truth = TruthSeries(e.recording, d);
  map.line_x = truth.x;
  map.line_y = truth.y;
  page->Chart(
      map, std::string("Posterior of ") + kQuantities[d].name +
               " over time (dark: probable), the truth as a dashed line. Hatched: no contact, nothing new is learnt.");
}

const Trace* TraceOf(const Experiment& e, const std::string& key) {
  for (const Trace& t : e.traces)
    if (t.key == key) return &t;
  return nullptr;
}

plots::Series PointSeries(const Experiment& e, const Trace& trace, std::size_t mode, std::size_t d, plots::Role role,
                          bool band) {
  plots::Series s{.label = trace.label, .role = role, .x = {}, .y = {}, .low = {}, .high = {}};
  const Recording& r = e.recording;
  for (std::size_t i = 0; i < r.size(); i += 20) {
    const PackTrace* shown = trace.ShownAt(i);
    const bool contact = !kContact.Is(r.plant) || r.u[0][i] >= 0.0;
    const bool known = contact && shown != nullptr && shown->modes[mode].known;
    s.x.push_back(TimeOf(r, i));
    s.y.push_back(known ? shown->modes[mode].map[d] : kNone);
    if (!band) continue;
    s.low.push_back(known ? shown->modes[mode].interval[2][d][0] : kNone);
    s.high.push_back(known ? shown->modes[mode].interval[2][d][1] : kNone);
  }
  return s;
}

void PointCharts(const Experiment& e, const Trace& ours, plots::Page* page) {
  for (std::size_t d = 0; d < 3; ++d) {
    plots::XyChart chart;
    chart.x_title = "t, s";
    chart.y_title = kQuantities[d].name;
    chart.sync = e.key;
    chart.height = 220;
    if (const Trace* rls = TraceOf(e, "rls"))
      chart.series.push_back(PointSeries(e, *rls, 0, d, plots::Role::kBefore, false));
    if (const Trace* pf = TraceOf(e, "pf"))
      chart.series.push_back(PointSeries(e, *pf, 0, d, plots::Role::kOther, false));
    chart.series.push_back(PointSeries(e, ours, 0, d, plots::Role::kAfter, true));
    chart.series.push_back(TruthSeries(e.recording, d));
    page->Chart(chart,
                std::string("Point estimates of ") + kQuantities[d].name + " as shown, with the 95 % band of ARMCMC.");
  }
}

void ForceChart(const Experiment& e, plots::Page* page) {
  plots::XyChart chart;
  chart.x_title = "t, s";
  chart.y_title = "|force error|, mN";
  chart.log_y = true;
  chart.sync = e.key;
  for (std::size_t k = 0; k < e.traces.size(); ++k) {
    const Trace& trace = e.traces[k];
    const plots::Role role = trace.key == "armcmc" ? plots::Role::kAfter
                             : trace.key == "rls"  ? plots::Role::kBefore
                             : trace.key == "pf"   ? plots::Role::kOther
                                                   : plots::Role::kMeasured;
    if (role == plots::Role::kMeasured && trace.key != "mcmc_1") continue;
    const std::vector<double> force = ShownForce(e.recording, trace, Point::kMap, e.settings[k]);
    plots::Series s{.label = trace.label, .role = role, .x = {}, .y = {}, .low = {}, .high = {}};
    for (std::size_t i = 0; i < force.size(); i += 10) {
      s.x.push_back(TimeOf(e.recording, i));
      s.y.push_back(e.recording.u[0][i] >= 0.0 ? 1e3 * std::fabs(force[i] - e.recording.target[i]) + 1e-2 : kNone);
    }
    chart.series.push_back(std::move(s));
  }
  page->Chart(chart, "Error of the predicted force against the true one.");
}

void AngleChart(const Experiment& e, plots::Page* page) {
  plots::XyChart chart;
  chart.x_title = "t, s";
  chart.y_title = "alpha, rad";
  chart.sync = e.key;
  chart.height = 300;
  plots::Series measured{.label = "measured", .role = plots::Role::kMeasured, .x = {}, .y = {}, .low = {}, .high = {}};
  for (std::size_t i = 0; i < e.recording.size(); i += 10) {
    measured.x.push_back(TimeOf(e.recording, i));
    measured.y.push_back(e.recording.y[i]);
  }
  chart.series.push_back(measured);
  for (std::size_t k = 0; k < e.traces.size(); ++k) {
    const Trace& trace = e.traces[k];
    if (trace.key != "armcmc" && trace.key != "rls" && trace.key != "pf") continue;
    const std::vector<double> angle = ShownAngle(e.recording, trace, Point::kMap, e.settings[k], false);
    const plots::Role role = trace.key == "armcmc" ? plots::Role::kAfter
                             : trace.key == "rls"  ? plots::Role::kBefore
                                                   : plots::Role::kOther;
    plots::Series s{.label = trace.label, .role = role, .x = measured.x, .y = {}, .low = {}, .high = {}};
    for (std::size_t i = 0; i < angle.size(); i += 10) s.y.push_back(angle[i]);
    chart.series.push_back(std::move(s));
  }
  page->Chart(chart, "Angle predicted from the valve inputs alone since the start, with the estimates on display.");
}

void GainCharts(const Experiment& e, const Trace& ours, plots::Page* page) {
  const std::array<const char*, 2> modes{"u_c", "u_d"};
  const std::array<const char*, 2> names{"g", "theta2"};
  for (std::size_t m = 0; m < 2; ++m)
    for (std::size_t d = 0; d < 2; ++d) {
      plots::XyChart chart;
      chart.x_title = "t, s";
      chart.y_title = std::string(names[d]) + " of " + modes[m];
      chart.height = 200;
      chart.sync = e.key;
      chart.series.push_back(PointSeries(e, ours, m, d, plots::Role::kAfter, true));
      plots::Series truth = TruthSeries(e.recording, d);
      for (std::size_t j = 0; j < truth.y.size(); ++j)
        if (e.recording.u[m][10 * j] == 0.0) truth.y[j] = kNone;
      chart.series.push_back(std::move(truth));
      page->Chart(chart, std::string(names[d]) + " of " + modes[m] + " as shown, with its 95 % band.");
    }
}

}  // namespace

void AddFigures(const Experiment& e, plots::Page* page) {
  const Trace* ours = TraceOf(e, "armcmc");
  if (ours == nullptr) return;
  if (kContact.Is(e.plant)) {
    const bool paper = e.key == kContact.key();
    if (paper)
      for (std::size_t d = 0; d < 3; ++d) DensityMap(e, *ours, d, page);
    if (paper || e.key == kContact.key("_step") || e.key == kContact.key("_drift")) PointCharts(e, *ours, page);
    ForceChart(e, page);
    return;
  }
  GainCharts(e, *ours, page);
  AngleChart(e, page);
}

void AddDrawNumbers(plots::Page* page) {
  constexpr double kEpsilon = 0.01, kDelta = 0.9;
  plots::XyChart chart;
  chart.x_title = "lambda";
  chart.y_title = "draws";
  plots::Series s{.label = "k_min", .role = plots::Role::kAfter, .x = {}, .y = {}, .low = {}, .high = {}};
  for (int i = 1; i <= 200; ++i) {
    s.x.push_back(i / 200.0);
    s.y.push_back(MinimumDraws(i / 200.0, kEpsilon, kDelta));
  }
  chart.series.push_back(s);
  chart.rules.push_back({static_cast<double>(ChernoffDraws(kEpsilon, kDelta)), "Chernoff bound"});
  page->Chart(
      chart,
      "Minimum number of draws over the forgetting factor, for the paper's epsilon = 0.01 and delta = 0.9. At lambda = "
      "0.7 it is 7406; the paper's 6000 belongs to 0.49.");
}

}  // namespace armcmc::tables
