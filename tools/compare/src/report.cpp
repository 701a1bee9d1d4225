#include "armcmc/compare/report.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <tuple>

#include "armcmc/plots/html.hpp"
#include "armcmc/plots/page.hpp"
#include "armcmc/support/text_table.hpp"
#include "figures_of_merit.hpp"

namespace armcmc::compare {
namespace {

using plots::EscapeHtml;
using plots::NumberText;
using plots::Role;
using plots::Series;
using plots::XyChart;

XyChart TimeChart(const std::string& y_title) {
  XyChart chart;
  chart.x_title = "time, s";
  chart.y_title = y_title;
  chart.sync = "time";
  return chart;
}

std::string WithUnit(const std::string& name, const std::string& unit) {
  return unit.empty() || unit == "-" ? name : name + ", " + unit;
}

/// The same numbers of both runs over time.
XyChart Both(const RunTrace& a, const RunTrace& b, const std::string& y_title, std::vector<double> RunTrace::*values) {
  XyChart chart = TimeChart(y_title);
  chart.series = {{"A", Role::kBefore, a.t, a.*values, {}, {}}, {"B", Role::kAfter, b.t, b.*values, {}, {}}};
  return chart;
}

/// Counts as they are, other numbers to five digits.
std::string Cell(double value) {
  const bool count = value == std::round(value) && std::fabs(value) < 1e9;
  return "<td class=\"num\">" + (count ? plots::FixedText(value, 0) : NumberText(value, 5)) + "</td>";
}

void AddSettings(const RunTrace& a, const RunTrace& b, plots::Page* page) {
  page->Html("<section class=\"card\" id=\"settings\"><h2>Different settings</h2>\n");
  const std::vector<SettingDifference> differences = DifferencesOf(a.settings, b.settings);
  if (differences.empty()) {
    page->Html("<p>None that changes an estimate.</p></section>\n");
    return;
  }
  page->Html("<table><tr><th>key</th><th>A</th><th>B</th></tr>\n");
  for (const SettingDifference& d : differences)
    page->Html("<tr><td class=\"mono\">" + EscapeHtml(d.key) + "</td><td>" + EscapeHtml(d.a) + "</td><td>" +
               EscapeHtml(d.b) + "</td></tr>\n");
  page->Html("</table></section>\n");
}

std::string EstimateCells(const QuantityTrace* q) {
  if (q == nullptr) return "<td class=\"num\">–</td><td class=\"num\">–</td>";
  return Cell(q->last) + "<td class=\"num\">" + NumberText(q->last_q025, 5) + " to " + NumberText(q->last_q975, 5) +
         "</td>";
}

void AddDifferences(const RunTrace& a, const RunTrace& b, plots::Page* page) {
  page->Html(
      "<section class=\"card\" id=\"differences\"><h2>Differences</h2>\n<p class=\"soft\">The last estimates. The "
      "distance is the difference over the standard deviations of both; both runs used the same data, so that chance "
      "explains less than it suggests.</p>\n<div class=\"scroll\"><table><tr><th>quantity</th><th>mode</th>"
      "<th class=\"num\">A</th><th class=\"num\">95 %</th><th class=\"num\">B</th><th class=\"num\">95 %</th>"
      "<th class=\"num\">B &minus; A</th><th class=\"num\">distance, sd</th></tr>\n");
  for (const EstimatePair& pair : PairsOf(a, b)) {
    const bool both = pair.a != nullptr && pair.b != nullptr;
    page->Html("<tr><td>" + EscapeHtml(WithUnit(pair.any().name, pair.any().unit)) + "</td><td>" +
               EscapeHtml(pair.any().mode) + "</td>" + EstimateCells(pair.a) + EstimateCells(pair.b) +
               Cell(both ? pair.b->last - pair.a->last : std::nan("")) + "<td class=\"num\">" +
               NumberText(pair.distance(), 2) + "</td></tr>\n");
  }
  page->Html(
      "</table></div>\n<table><tr><th>over the recording</th><th class=\"num\">A</th><th class=\"num\">B</th>"
      "<th class=\"num\">B &minus; A</th></tr>\n");
  for (const MeritRow& row : FiguresOfMerit(a, b))
    page->Html("<tr><td>" + EscapeHtml(WithUnit(row.what, row.unit)) + "</td>" + Cell(row.a) + Cell(row.b) +
               Cell(row.b - row.a) + "</tr>\n");
  page->Html("</table></section>\n");
}

void AddParameters(const RunTrace& a, const RunTrace& b, plots::Page* page) {
  page->Html("<section class=\"card\" id=\"parameters\"><h2>Parameters</h2>\n");
  for (const EstimatePair& pair : PairsOf(a, b)) {
    XyChart chart = TimeChart(WithUnit(pair.any().name, pair.any().unit));
    for (const auto& [q, label, role] : {std::tuple{pair.a, "A", Role::kBefore}, std::tuple{pair.b, "B", Role::kAfter}})
      if (q != nullptr) chart.series.push_back({label, role, q->t, q->ar_map, q->q025, q->q975});
    page->Chart(chart, EscapeHtml(pair.any().name) + ", mode " + EscapeHtml(pair.any().mode) +
                           ": AR-MAP and 95 % band. Drag to zoom, double-click to go back.");
  }
  page->Html("</section>\n");
}

void AddFit(const RunTrace& a, const RunTrace& b, plots::Page* page) {
  page->Html("<section class=\"card\" id=\"fit\"><h2>Fit</h2>\n");
  XyChart residual = TimeChart(a.output_name + " residual, " + a.output_unit);
  residual.series = {{"A", Role::kBefore, a.sample_t, a.residual, {}, {}},
                     {"B", Role::kAfter, b.sample_t, b.residual, {}, {}}};
  page->Chart(residual, "Measured minus predicted with the estimates that were on display at that time.");
  XyChart evidence = TimeChart("log evidence of B over A, nat");
  Series sum{"B over A", Role::kEffect, {}, {}, {}, {}};
  double total = 0.0;
  for (std::size_t i = 0; i < std::min(a.t.size(), b.t.size()); ++i) {
    if (!std::isfinite(a.log_evidence[i]) || !std::isfinite(b.log_evidence[i])) continue;
    total += b.log_evidence[i] - a.log_evidence[i];
    sum.x.push_back(b.t[i]);
    sum.y.push_back(total);
  }
  evidence.series.push_back(sum);
  page->Chart(
      evidence,
      "Rises where B predicts the packs better, falls where A does: the logarithm of the Bayes factor, added up "
      "over the packs. It is meaningful only for the same likelihood of the same samples, not across values "
      "of rho.");
  page->Html("</section>\n");
}

void AddDecisions(const RunTrace& a, const RunTrace& b, plots::Page* page) {
  page->Html("<section class=\"card\" id=\"decisions\"><h2>Decisions, draws and times</h2>\n");
  page->Chart(Both(a, b, "zeta", &RunTrace::zeta),
              "Mismatch of each pack with what was known before, in noise scales (nats for log_predictive).");
  XyChart decisions = Both(a, b, "lambda", &RunTrace::lambda);
  page->Chart(decisions, "Temporal forgetting factor: 1 keeps the past, 0 is a modification, which drops it. A has " +
                             std::to_string(a.modifications_t.size()) + " modifications, B " +
                             std::to_string(b.modifications_t.size()) + ".");
  XyChart draws = Both(a, b, "draws", &RunTrace::draws);
  draws.series.push_back({"A, k_min", Role::kOther, a.t, a.k_min, {}, {}});
  draws.series.push_back({"B, k_min", Role::kEffect, b.t, b.k_min, {}, {}});
  page->Chart(draws, "Draws made, and the number that the paper's relation requires.");
  page->Chart(Both(a, b, "computing time, ms", &RunTrace::compute_ms),
              "Adjust and execute of each pack on this machine, without a deadline: for orders of magnitude.");
  page->Html("</section>\n");
}

}  // namespace

std::string ReportHtml(const RunTrace& a, const RunTrace& b, const std::string& recording) {
  plots::Page page("Comparison");
  page.Html("<main><p class=\"over\">ARMCMC comparison</p><h1>" + EscapeHtml(recording) +
            "</h1>\n<dl class=\"facts\">" + "<dt>A</dt><dd>" + EscapeHtml(a.label) + "</dd><dt>B</dt><dd>" +
            EscapeHtml(b.label) + "</dd></dl>\n");
  AddSettings(a, b, &page);
  AddDifferences(a, b, &page);
  AddParameters(a, b, &page);
  AddFit(a, b, &page);
  AddDecisions(a, b, &page);
  page.Html("</main>\n");
  return page.ToString();
}

std::string SummaryText(const RunTrace& a, const RunTrace& b) {
  using support::Significant;
  support::TextTable table({"", "A", "B", "B - A"});
  const auto text = [](const QuantityTrace* q) {
    return q == nullptr ? std::string("-") : Significant(q->last, 5) + " ± " + Significant(q->last_sd, 2);
  };
  for (const EstimatePair& pair : PairsOf(a, b)) {
    const bool both = pair.a != nullptr && pair.b != nullptr;
    table.AddRow({pair.any().mode + " " + WithUnit(pair.any().name, pair.any().unit), text(pair.a), text(pair.b),
                  both ? Significant(pair.b->last - pair.a->last, 3) : "-"});
  }
  for (const MeritRow& row : FiguresOfMerit(a, b))
    table.AddRow(
        {WithUnit(row.what, row.unit), Significant(row.a, 5), Significant(row.b, 5), Significant(row.b - row.a, 3)});
  std::ostringstream out;
  out << "A: " << a.label << "\nB: " << b.label << '\n' << table.ToString();
  return out.str();
}

}  // namespace armcmc::compare
