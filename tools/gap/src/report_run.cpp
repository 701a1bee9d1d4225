// The estimator run over the recording: predictions one pack ahead, and drift of the parameters.
#include <cmath>
#include <sstream>
#include <string>

#include "armcmc/plots/html.hpp"
#include "report_sections.hpp"
#include "report_words.hpp"

namespace armcmc::gap {
namespace {

using plots::EscapeHtml;
using plots::PercentText;
using plots::Role;
using plots::XyChart;

void AddScore(const std::string& model, const OneStepScore& score, const std::string& unit, std::ostream& out) {
  out << "<tr><td>" << model << "</td><td class=\"num\">" << score.samples << "</td><td class=\"num\">"
      << WithUnit(score.rmse, 3, unit) << "</td><td class=\"num\">" << PercentText(score.coverage95)
      << "</td><td class=\"num\">± " << WithUnit(score.half_width, 3, unit) << "</td></tr>\n";
}

/// Interprets the coverage of the 95 % intervals.
std::string Reading(double coverage) {
  constexpr double kTooFew = 0.9, kTooMany = 0.985;
  if (!std::isfinite(coverage)) return "";
  if (coverage < kTooFew)
    return "The intervals contain fewer than 95 % of the samples: they are too narrow, since the model error varies "
           "from pack to pack.";
  if (coverage > kTooMany) return "The intervals contain more than 95 % of the samples: they are wider than necessary.";
  return "The intervals contain about 95 % of the samples.";
}

void AddOneStep(const Result& result, plots::Page* page) {
  const RunAlong& run = result.run;
  const std::string& unit = result.gap.unit;
  std::ostringstream out;
  out << "<h3>Predicted one pack ahead</h3>\n<p class=\"soft\">The estimator ran over the recording as it does live, "
      << WithUnit(run.pack_s, 3, "s")
      << " at a time: it predicted each pack before processing it. Its prior is centred on the fit of the diagnosis "
         "and three times as wide as the uncertainty of that fit.</p>\n<div "
         "class=\"scroll\"><table>\n<tr><th>model</th><th "
         "class=\"num\">samples</th><th class=\"num\">error (rms)</th><th class=\"num\">inside the 95 % "
         "interval</th><th class=\"num\">interval</th></tr>\n";
  AddScore("base model", run.before, unit, out);
  if (run.has_after) AddScore("<b>with the named effects</b>", run.after, unit, out);
  if (run.before_apart.samples > 0) {
    AddScore("base model, held-out rows", run.before_apart, unit, out);
    if (run.has_after) AddScore("<b>with the named effects</b>, held-out rows", run.after_apart, unit, out);
  }
  out << "</table></div>\n<p>" << Reading((run.has_after ? run.after : run.before).coverage95) << "</p>\n";
  page->Html(out.view());

  XyChart chart;
  chart.x_title = "time, s";
  chart.y_title = "error" + (unit.empty() ? "" : ", " + unit);
  const auto add = [&](const Curve& curve, Role role, const char* label, bool band) {
    if (curve.x.empty()) return;
    chart.series.push_back({label, role, curve.x, curve.y, band ? curve.low : std::vector<double>{},
                            band ? curve.high : std::vector<double>{}});
  };
  add(run.error_before, Role::kBefore, run.has_after ? "before" : "base model", !run.has_after);
  add(run.error_after, Role::kAfter, "with the named effects", true);
  ShadeHeldOut(result.figures, &chart);
  page->Chart(
      chart,
      "Prediction error of every sample, one pack ahead. The band is the 95 % interval of the prediction; 95 % of the "
      "samples should lie within it.");
}

std::string ConstancyCell(const Constancy& s, const std::string& unit) {
  if (!s.known())
    return s.fitted ? "<td></td><td class=\"soft\">not determined</td>" : "<td class=\"soft num\">–</td><td></td>";
  std::string cell = "<td class=\"num\">" + WithUnit(s.mean, 4, unit) + "</td><td>";
  if (s.constant) return cell + "<span class=\"chip small good\">constant</span></td>";
  return cell + "<span class=\"chip small doubt\">varies by ± " + WithUnit(s.moves_by, 2, unit) + "</span></td>";
}

void AddDrift(const Result& result, plots::Page* page) {
  const bool has_after = HasAfter(result);
  std::ostringstream out;
  out << "<h3>Constancy of the parameters</h3>\n<p class=\"soft\">The model was refitted to each of "
      << result.drift.front().before.course.x.size()
      << " segments of the recording. A parameter is constant if its values differ no more than their uncertainty "
         "allows (p-value at least 0.01); otherwise the table gives the standard deviation of its values beyond that "
         "uncertainty. A parameter that varies indicates that the plant changes, or that the model lacks an effect "
         "which the parameter absorbs.</p>\n<div class=\"scroll\"><table>\n<tr><th>parameter</th><th "
         "class=\"num\">base model</th><th></th>";
  if (has_after) out << "<th class=\"num\">with the named effects</th><th></th>";
  out << "</tr>\n";
  for (const ParameterDrift& p : result.drift) {
    out << "<tr><td class=\"mono\">" << EscapeHtml(p.name) << "</td>" << ConstancyCell(p.before, p.unit);
    if (has_after) out << ConstancyCell(p.after, p.unit);
    out << "</tr>\n";
  }
  out << "</table></div>\n<div class=\"grid\">\n";
  page->Html(out.view());
  for (const ParameterDrift& p : result.drift) {
    XyChart chart;
    chart.x_title = "time, s";
    chart.y_title = p.name + (p.unit.empty() || p.unit == "1" ? "" : ", " + p.unit);
    chart.height = 210;
    chart.sync = "drift";
    const auto add = [&](const Curve& curve, Role role, const char* label) {
      if (!curve.x.empty()) chart.series.push_back({label, role, curve.x, curve.y, curve.low, curve.high});
    };
    add(p.before.course, Role::kBefore, has_after ? "before" : "base model");
    add(p.after.course, Role::kAfter, "with the named effects");
    page->Chart(chart, "<b>" + EscapeHtml(p.name) + "</b> in each segment, with its 95 % band.");
  }
  page->Html("</div>\n");
}

}  // namespace

void AddRunAlong(const Result& result, plots::Page* page) {
  const RunAlong& run = result.run;
  if (!run.done && run.why_not.empty() && result.drift.empty()) return;
  page->Html("<section class=\"card\" id=\"run\">\n<h2>The estimator on this recording</h2>\n");
  if (!result.drift.empty()) AddDrift(result, page);
  if (run.done) AddOneStep(result, page);
  if (!run.why_not.empty())
    page->Html("<h3>Predicted one pack ahead</h3>\n<p>Not available: " + EscapeHtml(run.why_not) + ".</p>\n");
  page->Html("</section>\n");
}

}  // namespace armcmc::gap
