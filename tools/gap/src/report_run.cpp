// What the estimator made of the recording as it went by: predictions one pack ahead, and whether parameters stay.
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

/// What a share of samples inside their intervals says.
std::string Reading(double coverage) {
  constexpr double kTooFew = 0.9, kTooMany = 0.985;
  if (!std::isfinite(coverage)) return "";
  if (coverage < kTooFew)
    return "The intervals hold fewer samples than the 95 % that they promise: it is surer of itself than it may be, "
           "since what it lacks changes from pack to pack.";
  if (coverage > kTooMany)
    return "The intervals hold more than the 95 % that they promise: they are wider than need be.";
  return "The intervals hold about what they promise.";
}

void AddOneStep(const Result& result, plots::Page* page) {
  const RunAlong& run = result.run;
  const std::string& unit = result.gap.unit;
  std::ostringstream out;
  out << "<h3>Predicted one pack ahead</h3>\n<p class=\"soft\">The estimator went over the recording as it does live, "
      << WithUnit(run.pack_s, 3, "s")
      << " at a time: it predicted each pack before it saw it, and then learnt from it. It began from what the "
         "diagnosis "
         "had fitted, three times as wide as these data leave it.</p>\n<div "
         "class=\"scroll\"><table>\n<tr><th>model</th><th "
         "class=\"num\">samples</th><th class=\"num\">error (rms)</th><th class=\"num\">inside the 95 % "
         "interval</th><th "
         "class=\"num\">interval</th></tr>\n";
  AddScore("as it is", run.before, unit, out);
  if (run.has_after) AddScore("<b>with what was named</b>", run.after, unit, out);
  if (run.before_apart.samples > 0) {
    AddScore("as it is, held-out rows", run.before_apart, unit, out);
    if (run.has_after) AddScore("<b>with what was named</b>, held-out rows", run.after_apart, unit, out);
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
  add(run.error_before, Role::kBefore, run.has_after ? "before" : "model as it is", !run.has_after);
  add(run.error_after, Role::kAfter, "with what was named", true);
  ShadeHeldOut(result.figures, &chart);
  page->Chart(
      chart,
      "Error of every sample against what was predicted before its pack was seen. The band is the 95 % interval "
      "that was given with the prediction: nineteen samples in twenty should lie in it.");
}

std::string SteadinessCell(const Steadiness& s, const std::string& unit) {
  if (!s.known())
    return s.fitted ? "<td></td><td class=\"soft\">not told</td>" : "<td class=\"soft num\">–</td><td></td>";
  std::string cell = "<td class=\"num\">" + WithUnit(s.mean, 4, unit) + "</td><td>";
  if (s.constant) return cell + "<span class=\"chip small good\">constant</span></td>";
  return cell + "<span class=\"chip small doubt\">moves by ± " + WithUnit(s.moves_by, 2, unit) + "</span></td>";
}

void AddDrift(const Result& result, plots::Page* page) {
  const bool has_after = HasAfter(result);
  std::ostringstream out;
  out << "<h3>Whether the parameters stay</h3>\n<p class=\"soft\">The model was fitted anew to each of "
      << result.drift.front().before.course.x.size()
      << " stretches of the recording. A parameter counts as constant when its values differ no more than their bands "
         "say (probability of more by chance at least 1 %); else it moves, from stretch to stretch by so much "
         "as the bands do not explain. One that moves is the sign of a plant that changes, or of a model that "
         "lacks "
         "something and bends its parameters instead.</p>\n<div class=\"scroll\"><table>\n<tr><th>parameter</th><th "
         "class=\"num\">as it is</th><th></th>";
  if (has_after) out << "<th class=\"num\">with what was named</th><th></th>";
  out << "</tr>\n";
  for (const ParameterDrift& p : result.drift) {
    out << "<tr><td class=\"mono\">" << EscapeHtml(p.name) << "</td>" << SteadinessCell(p.before, p.unit);
    if (has_after) out << SteadinessCell(p.after, p.unit);
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
    add(p.before.course, Role::kBefore, has_after ? "before" : "model as it is");
    add(p.after.course, Role::kAfter, "with what was named");
    page->Chart(chart, "<b>" + EscapeHtml(p.name) + "</b> in each stretch, with its 95 % band.");
  }
  page->Html("</div>\n");
}

}  // namespace

void AddRunAlong(const Result& result, plots::Page* page) {
  const RunAlong& run = result.run;
  if (!run.done && run.why_not.empty() && result.drift.empty()) return;
  page->Html("<section class=\"card\" id=\"run\">\n<h2>While the data went by</h2>\n");
  if (!result.drift.empty()) AddDrift(result, page);
  if (run.done) AddOneStep(result, page);
  if (!run.why_not.empty())
    page->Html("<h3>Predicted one pack ahead</h3>\n<p>Not told: " + EscapeHtml(run.why_not) + ".</p>\n");
  page->Html("</section>\n");
}

}  // namespace armcmc::gap
