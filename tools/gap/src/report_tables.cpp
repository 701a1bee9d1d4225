// Tables: parameters, quality, limits, provenance.
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "armcmc/plots/html.hpp"
#include "report_sections.hpp"
#include "report_words.hpp"

namespace armcmc::gap {
namespace {

using plots::EscapeHtml;
using plots::FixedText;
using plots::NumberText;
using plots::PercentText;

/// Maps numbers to the width of a row, in percent.
struct Scale {
  double low, high;
  [[nodiscard]] std::string At(double value) const {
    const double share = high > low ? (value - low) / (high - low) : 0.5;
    return FixedText(4.0 + 92.0 * std::clamp(share, 0.0, 1.0), 2) + "%";
  }
};

double HalfWidth(const ParameterEstimate& p) { return std::isfinite(p.sd) ? 1.96 * std::max(p.sd, 0.0) : 0.0; }

std::string Interval(const char* kind, const ParameterEstimate& p, const Scale& scale) {
  if (!std::isfinite(p.mean)) return "";
  const double half = HalfWidth(p);
  return std::string("<div class=\"interval ") + kind + "\"><i style=\"left:" + scale.At(p.mean - half) +
         ";right:calc(100% - " + scale.At(p.mean + half) + ")\"></i><b style=\"left:" + scale.At(p.mean) +
         "\"></b></div>";
}

std::string ParameterRow(const ParameterChange& change, bool has_after) {
  const ParameterEstimate &b = change.before, &a = change.after;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Scale scale{kInfinity, -kInfinity};
  for (const ParameterEstimate* p : {&b, has_after ? &a : &b}) {
    if (!std::isfinite(p->mean)) continue;
    scale.low = std::min(scale.low, p->mean - HalfWidth(*p));
    scale.high = std::max(scale.high, p->mean + HalfWidth(*p));
  }
  const auto cell = [](const ParameterEstimate& p) {
    return "<td class=\"num middle\">" + MeanText(p) + "<br><span class=\"soft\">" + IntervalText(p) + "</span></td>";
  };
  std::string row = "<tr><td class=\"middle\"><b>" + EscapeHtml(b.name) + "</b></td>" + cell(b);
  if (has_after) row += cell(a);
  row += "<td class=\"wide middle\">" + Interval("before", b, scale) + (has_after ? Interval("after", a, scale) : "") +
         "</td>";
  if (has_after)
    row += "<td class=\"num middle\">" +
           (b.sd > 0.0 ? FixedText((a.mean - b.mean) / b.sd, 1) + " sd" : std::string("–")) + "</td>";
  return row + "</tr>\n";
}

void QualityRow(const char* what, const std::string& before, const std::string& after, const std::string& reading,
                bool has_after, std::ostream& out) {
  out << "<tr><td>" << what << "</td><td class=\"num\">" << before << "</td>";
  if (has_after) out << "<td class=\"num\">" << after << "</td>";
  out << "<td class=\"wide\">" << reading << "</td></tr>\n";
}

void AddModes(const Result& result, bool has_after, std::ostream& out) {
  if (result.gap.modes.empty()) return;
  const std::string unit = result.gap.unit.empty() ? "" : ", " + EscapeHtml(result.gap.unit);
  out << "<h3>By regime</h3>\n<div class=\"scroll\"><table class=\"narrow\">\n<tr><th>regime</th><th "
         "class=\"num\">samples</th><th class=\"num\">"
      << (has_after ? "rms error before" : "rms error") << unit << "</th>"
      << (has_after ? "<th class=\"num\">after" + unit + "</th>" : "") << "</tr>\n";
  for (const ModeFit& m : result.gap.modes)
    out << "<tr><td>" << EscapeHtml(m.mode) << "</td><td class=\"num\">" << m.samples << "</td><td class=\"num\">"
        << NumberText(m.rmse_before, 3) << "</td>"
        << (has_after ? "<td class=\"num\">" + NumberText(m.rmse_after, 3) + "</td>" : "") << "</tr>\n";
  out << "</table></div>\n";
}

void AddList(const char* title, const std::vector<std::string>& lines, std::ostream& out) {
  if (lines.empty()) return;
  out << "<h3>" << title << "</h3>\n<ul class=\"plain\">\n";
  for (const std::string& line : lines) out << "<li>" << EscapeHtml(line) << "</li>\n";
  out << "</ul>\n";
}

}  // namespace

void AddParameters(const Result& result, plots::Page* page) {
  if (result.parameters.empty()) return;
  const bool has_after = HasAfter(result);
  std::ostringstream out;
  out << "<section class=\"card\" id=\"parameters\">\n<h2>Parameters of the base model</h2>\n<p class=\"soft\">"
      << (has_after ? "Without and with the added effects: a missing effect biases the parameters. Dots are estimates, "
                      "lines 95 % intervals; each row has its own scale."
                    : "Estimates with 95 % intervals.")
      << "</p>\n<div class=\"scroll\"><table>\n<tr><th>parameter</th><th class=\"num\">"
      << (has_after ? "before" : "estimate") << "</th>" << (has_after ? "<th class=\"num\">after</th>" : "")
      << "<th></th>" << (has_after ? "<th class=\"num\">change</th>" : "") << "</tr>\n";
  for (const ParameterChange& change : result.parameters) out << ParameterRow(change, has_after);
  out << "</table></div>\n"
      << (has_after ? "<p class=\"soft\">Orange: before. Blue: after. Change: in standard deviations of the estimate "
                      "before.</p>\n"
                    : "")
      << "</section>\n";
  page->Html(out.view());
}

void AddQuality(const Result& result, plots::Page* page) {
  const bool has_after = HasAfter(result);
  const Fit &b = result.gap.before, &a = result.gap.after, &last = has_after ? a : b;
  const std::string& unit = result.gap.unit;
  std::ostringstream out;
  out << "<section class=\"card\" id=\"quality\">\n<h2>Quality of the prediction</h2>\n<p class=\"soft\">On held-out "
         "data.</p>\n<div class=\"scroll\"><table>\n<tr><th></th><th class=\"num\">"
      << (has_after ? "before" : "base model") << "</th>" << (has_after ? "<th class=\"num\">after</th>" : "")
      << "<th>interpretation</th></tr>\n";
  const double ratio = last.rmse / result.gap.noise_floor;
  QualityRow("root mean square error", WithUnit(b.rmse, 3, unit), WithUnit(a.rmse, 3, unit),
             std::isfinite(ratio) ? FixedText(ratio, 2) + " times the noise floor" : "", has_after, out);
  QualityRow("mean absolute error", WithUnit(b.mae, 3, unit), WithUnit(a.mae, 3, unit), "", has_after, out);
  QualityRow("99 % quantile of the absolute error", WithUnit(b.worst_1_percent, 3, unit),
             WithUnit(a.worst_1_percent, 3, unit), "exceeded by one sample in a hundred", has_after, out);
  QualityRow("inside the 95 % band", PercentText(b.coverage95), PercentText(a.coverage95),
             CoverageReading(last.coverage95), has_after, out);
  QualityRow("whiteness (Ljung–Box over degrees of freedom; 1 is white)", NumberText(b.whiteness, 3),
             NumberText(a.whiteness, 3), WhitenessReading(last.whiteness), has_after, out);
  out << "</table></div>\n";
  AddModes(result, has_after, out);
  out << "</section>\n";
  page->Html(out.view());
}

void AddLimits(const Result& result, plots::Page* page) {
  std::ostringstream out;
  out << "<section class=\"card\" id=\"limits\">\n<h2>Limits</h2>\n";
  AddList("What these inputs cannot reveal", result.aliases, out);
  AddList("Notes", result.notes, out);
  out << "<h3>Step time of the estimator</h3>\n";
  const Budget& budget = result.budget;
  if (!budget.measured) {
    out << "<p>Not measured in this run.</p>\n";
  } else {
    out << "<p>" << NumberText(budget.adjust_ms_before, 3) << " ms";
    if (HasAfter(result))
      out << " before, <b>" << NumberText(budget.adjust_ms_after, 3) << " ms</b> with the added effects";
    out << "; the deadline is " << NumberText(budget.deadline_ms, 3)
        << " ms: " << (budget.meets_deadline ? "met." : "<b>missed; do not run this model in real time.</b>")
        << "</p>\n";
  }
  out << "</section>\n";
  page->Html(out.view());
}

void AddProvenance(const Result& result, plots::Page* page) {
  std::ostringstream out;
  out << "<section class=\"card\" id=\"provenance\">\n<h2>Provenance</h2>\n<dl "
         "class=\"facts\">\n<dt>Data</dt><dd><code>"
      << EscapeHtml(result.data_file) << "</code></dd>\n<dt>SHA-256</dt><dd><code>" << EscapeHtml(result.data_sha256)
      << "</code></dd>\n<dt>Rows</dt><dd>" << result.rows;
  if (result.dt > 0.0 && std::isfinite(result.dt))
    out << ", one every " << NumberText(1e3 * result.dt, 4) << " ms (" << NumberText(1.0 / result.dt, 4) << " Hz)";
  out << "</dd>\n<dt>Base model</dt><dd><code>" << EscapeHtml(result.model) << "</code></dd>\n<dt>Seed</dt><dd>"
      << result.seed << "</dd>\n<dt>Program</dt><dd>armcmc-gap " << EscapeHtml(result.version) << "</dd>\n";
  if (!result.seconds.empty()) {
    out << "<dt>Run time</dt><dd>";
    double sum = 0.0;
    for (const auto& [step, seconds] : result.seconds) {
      out << EscapeHtml(step) << " " << NumberText(seconds, 2) << " s, ";
      sum += seconds;
    }
    out << "total " << NumberText(sum, 2) << " s</dd>\n";
  }
  out << "</dl>\n</section>\n<footer>result.json holds every number on this page except the curves. Plots: uPlot (MIT "
         "licence, in the source of this page).</footer>\n";
  page->Html(out.view());
}

}  // namespace armcmc::gap
