// The curves of the report.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "armcmc/plots/html.hpp"
#include "report_sections.hpp"

namespace armcmc::gap {
namespace {

using plots::EscapeHtml;
using plots::Role;
using plots::Series;
using plots::XyChart;

void AddCurve(const Curve& curve, Role role, const char* label, XyChart* chart) {
  if (curve.x.empty()) return;
  chart->series.push_back({curve.label.empty() ? label : curve.label, role, curve.x, curve.y, curve.low, curve.high});
}

/// "force, N" -> "force residual, N".
std::string ResidualTitle(const std::string& output_title) {
  if (output_title.empty()) return "residual";
  const std::size_t comma = output_title.rfind(", ");
  return comma == std::string::npos ? output_title + " residual"
                                    : output_title.substr(0, comma) + " residual" + output_title.substr(comma);
}

}  // namespace

void ShadeHeldOut(const Figures& figures, XyChart* chart) {
  double end = -std::numeric_limits<double>::infinity();
  for (const Series& s : chart->series)
    for (const double x : s.x)
      if (std::isfinite(x)) end = std::max(end, x);
  if (std::isfinite(figures.diagnosis_end_s) && end > figures.diagnosis_end_s)
    chart->shades.push_back({figures.diagnosis_end_s, end, "held out"});
}

void AddTimeFigures(const Result& result, plots::Page* page) {
  const Figures& f = result.figures;
  page->Html("<section class=\"card\" id=\"time\">\n<h2>Over time</h2>\n");
  const bool held_out_here = std::isfinite(f.diagnosis_end_s);
  const std::string held_out = held_out_here ? " The shaded part is held out from the diagnosis."
                                             : " All of it is from a separate held-out recording.";

  XyChart residual;
  residual.x_title = "time, s";
  residual.y_title = ResidualTitle(f.output_title);
  residual.sync = "time";
  AddCurve(f.residual_before, Role::kBefore, HasAfter(result) ? "before" : "base model", &residual);
  if (HasAfter(result)) AddCurve(f.residual_after, Role::kAfter, "after", &residual);
  ShadeHeldOut(f, &residual);
  page->Chart(residual, "Measured minus predicted: a complete model leaves stationary noise around zero." + held_out +
                            " Drag to zoom, double-click to reset.");

  XyChart output;
  output.x_title = "time, s";
  output.y_title = f.output_title;
  output.sync = "time";
  AddCurve(f.measured, Role::kMeasured, "measured", &output);
  AddCurve(f.predicted_before, Role::kBefore, HasAfter(result) ? "predicted before" : "predicted", &output);
  if (HasAfter(result)) AddCurve(f.predicted_after, Role::kAfter, "predicted after", &output);
  ShadeHeldOut(f, &output);
  page->Chart(output, "Measured and predicted output on the same time axis.");
  page->Html("</section>\n");
}

void AddFeatureFigures(const Result& result, plots::Page* page) {
  const Figures& f = result.figures;
  if (f.features.empty()) return;
  page->Html(
      "<section class=\"card\" id=\"features\">\n<h2>What the error depends on</h2>\n<p class=\"soft\">Mean residual "
      "as a function of each quantity, with 95 % bands. A slope, a step or a bend is structure that the model "
      "lacks.</p>\n<div class=\"grid\">\n");
  for (const FeatureFigure& figure : f.features) {
    XyChart chart;
    chart.x_title = figure.feature;
    chart.y_title = "mean residual" + (result.gap.unit.empty() ? "" : ", " + result.gap.unit);
    chart.height = 230;
    AddCurve(figure.before, Role::kBefore, HasAfter(result) ? "before" : "base model", &chart);
    if (HasAfter(result)) {
      AddCurve(figure.after, Role::kAfter, "after", &chart);
      AddCurve(figure.effect, Role::kEffect, "added effect", &chart);
    }
    page->Chart(chart, HasAfter(result) && !figure.effect.x.empty()
                           ? "Against <b>" + EscapeHtml(figure.feature) +
                                 "</b>: the added effect (dashed) should follow the residual before; the residual "
                                 "after should be zero."
                           : "Against <b>" + EscapeHtml(figure.feature) +
                                 "</b>: where the band excludes zero, the model has a systematic error.");
  }
  page->Html("</div>\n</section>\n");
}

void AddSpectrum(const Result& result, plots::Page* page) {
  const Figures& f = result.figures;
  if (f.spectrum_before.x.empty()) return;
  XyChart chart;
  chart.x_title = "frequency, Hz";
  chart.y_title = "power relative to white noise";
  chart.log_x = chart.log_y = true;
  chart.rules.push_back({1.0, "white noise"});
  AddCurve(f.spectrum_before, Role::kBefore, HasAfter(result) ? "before" : "base model", &chart);
  if (HasAfter(result)) AddCurve(f.spectrum_after, Role::kAfter, "after", &chart);
  page->Html("<section class=\"card\" id=\"spectrum\">\n<h2>Spectrum</h2>\n");
  page->Chart(chart, "Spectrum of the whitened residual: power above 1 is not explained by the noise model.");
  page->Html("</section>\n");
}

}  // namespace armcmc::gap
