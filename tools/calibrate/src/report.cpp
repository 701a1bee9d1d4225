#include "armcmc/calibrate/report.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "armcmc/noise_model.hpp"
#include "armcmc/plots/html.hpp"
#include "armcmc/plots/page.hpp"
#include "armcmc/support/text_table.hpp"

namespace armcmc::calibrate {
namespace {

using plots::EscapeHtml;
using plots::NumberText;
using plots::Role;
using support::Significant;

std::string Shape(const NoiseSettings& noise) {
  if (noise.kind == NoiseKind::kStudentT) return "dof " + Significant(noise.dof, 3);
  if (noise.kind == NoiseKind::kMixture)
    return "outliers " + Significant(100.0 * noise.outlier_weight, 3) + " %, " + Significant(noise.outlier_scale, 3) +
           " times as wide";
  return "";
}

/// Histogram of the errors as a density, and what the fitted laws say.
plots::XyChart ErrorChart(const ModeNoise& noise, const std::string& unit) {
  constexpr std::size_t kBins = 80;
  std::vector<double> sorted = noise.errors;
  std::sort(sorted.begin(), sorted.end());
  const double reach = 1.02 * std::max(std::fabs(sorted.front()), std::fabs(sorted.back()));
  const double width = 2.0 * reach / kBins;
  std::vector<double> count(kBins, 0.0);
  for (const double e : noise.errors) count[std::min(kBins - 1, static_cast<std::size_t>((e + reach) / width))] += 1.0;
  plots::XyChart chart;
  chart.x_title = "error, " + unit;
  chart.y_title = "density, 1/" + unit;
  chart.log_y = true;
  plots::Series seen{"measured", Role::kMeasured, {}, {}, {}, {}};
  for (std::size_t b = 0; b < kBins; ++b) {
    if (count[b] == 0.0) continue;
    seen.x.push_back(-reach + (static_cast<double>(b) + 0.5) * width);
    seen.y.push_back(count[b] / (static_cast<double>(noise.errors.size()) * width));
  }
  chart.series.push_back(seen);
  const double smallest = 0.2 / (static_cast<double>(noise.errors.size()) * width);
  for (std::size_t law = 0; law < noise.laws.size(); ++law) {
    const NoiseSettings& fitted = noise.laws[law].noise;
    if (law != noise.chosen && fitted.kind != NoiseKind::kGaussian) continue;
    const NoiseModel model(fitted);
    plots::Series curve{std::string(Name(fitted.kind)) + (law == noise.chosen ? ", chosen" : ""),
                        law == noise.chosen ? Role::kAfter : Role::kBefore,
                        {},
                        {},
                        {},
                        {}};
    for (std::size_t b = 0; b <= 4 * kBins; ++b) {
      const double e = -reach + 0.25 * static_cast<double>(b) * width,
                   density = std::exp(model.LogDensity(e, fitted.std));
      if (density < smallest) continue;
      curve.x.push_back(e);
      curve.y.push_back(density);
    }
    chart.series.push_back(curve);
  }
  return chart;
}

void AddNoise(const ModeNoise& noise, const std::string& unit, plots::Page* page) {
  page->Html("<section class=\"card\"><h2>Noise, mode " + EscapeHtml(noise.mode) + "</h2>\n");
  if (!noise.calibrated) {
    page->Html("<p>Unchanged: " + EscapeHtml(noise.why_not) + ".</p></section>\n");
    return;
  }
  page->Html(
      "<p class=\"soft\">" + std::to_string(noise.samples) + " errors in " + std::to_string(noise.packs) +
      " packs. Every law was fitted to one half of the packs and scored on the other. The simplest "
      "within two standard errors of the best is chosen.</p>\n<table><tr><th>law</th><th class=\"num\">scale, " +
      EscapeHtml(unit) +
      "</th><th>shape</th><th class=\"num\">held-out log density per sample</th><th class=\"num\">behind the best "
      "</th><th class=\"num\">standard error</th></tr>\n");
  for (std::size_t law = 0; law < noise.laws.size(); ++law) {
    const LawScore& score = noise.laws[law];
    const bool chosen = law == noise.chosen;
    page->Html("<tr><td>" + std::string(chosen ? "<b>" : "") + EscapeHtml(Name(score.noise.kind)) +
               (chosen ? "</b> (chosen)" : "") + "</td><td class=\"num\">" + NumberText(score.noise.std, 4) +
               "</td><td>" + EscapeHtml(Shape(score.noise)) + "</td><td class=\"num\">" + NumberText(score.heldout, 5) +
               "</td><td class=\"num\">" + NumberText(score.behind, 3) + "</td><td class=\"num\">" +
               NumberText(score.behind_se, 2) + "</td></tr>\n");
  }
  page->Html("</table>\n");
  page->Chart(ErrorChart(noise, unit),
              "Density of the errors, measured and by the fitted laws. A law whose tails are below the measured ones "
              "treats outliers as information.");
  page->Html("</section>\n");
}

void AddRho(const Calibration& c, plots::Page* page) {
  if (c.rho.empty()) return;
  page->Html("<section class=\"card\"><h2>Weight of the past within a pack</h2>\n");
  plots::XyChart chart;
  chart.x_title = "rho";
  chart.y_title = "behind the best, nats per sample";
  plots::Series curve{"prediction of the next pack", Role::kAfter, {}, {}, {}, {}};
  for (const RhoScore& score : c.rho) {
    curve.x.push_back(score.rho);
    curve.y.push_back(score.behind);
    curve.low.push_back(score.behind - 2.0 * score.behind_se);
    curve.high.push_back(score.behind + 2.0 * score.behind_se);
  }
  chart.series.push_back(curve);
  page->Chart(chart,
              "How much worse the next pack is predicted than with the best rho; the band is two standard errors "
              "wide on each side. The smallest rho whose band reaches zero is chosen: " +
                  NumberText(c.settings.forgetting.rho, 3) + ".");
  page->Html("</section>\n");
}

void AddThreshold(const Calibration& c, plots::Page* page) {
  page->Html("<section class=\"card\"><h2>Threshold of a change of the plant</h2>\n");
  plots::XyChart over_time, tail;
  over_time.x_title = "time, s";
  over_time.y_title = "score";
  plots::Series scores{"score of a pack", Role::kAfter, {}, {}, {}, {}};
  std::vector<double> sorted;
  for (const ThresholdSample& sample : c.scores) {
    scores.x.push_back(sample.t);
    scores.y.push_back(sample.score);
    sorted.push_back(sample.score);
  }
  over_time.series.push_back(scores);
  if (!scores.x.empty())
    over_time.series.push_back({"threshold",
                                Role::kBefore,
                                {scores.x.front(), scores.x.back()},
                                {c.threshold.threshold, c.threshold.threshold},
                                {},
                                {}});
  page->Chart(
      over_time,
      "The threshold at which each pack would just have been classified as a change: the mismatch in noise scales, "
      "less what chance explains. The plant did not change in this recording.");
  std::sort(sorted.begin(), sorted.end());
  tail.x_title = "threshold";
  tail.y_title = "share of packs at or above";
  tail.log_y = true;
  plots::Series share{"measured", Role::kMeasured, {}, {}, {}, {}};
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    share.x.push_back(sorted[i]);
    share.y.push_back(static_cast<double>(sorted.size() - i) / static_cast<double>(sorted.size()));
  }
  // Where nothing reaches the threshold, half a pack stands for it.
  const double reached = c.threshold.extrapolated
                             ? c.false_modifications
                             : std::max(c.threshold.measured_rate, 0.5 / static_cast<double>(sorted.size()));
  tail.series = {share, {"chosen", Role::kAfter, {c.threshold.threshold}, {reached}, {}, {}}};
  tail.rules.push_back({c.false_modifications, "requested"});
  page->Chart(tail, "Share of the packs that a threshold would have classified as a change.");
  page->Html("</section>\n");
}

}  // namespace

std::string ReportHtml(const Calibration& c, const std::string& recording, const std::string& config,
                       const std::string& unit) {
  plots::Page page("Calibration");
  page.Html("<main><p class=\"over\">ARMCMC calibration</p><h1>" + EscapeHtml(recording) + "</h1>\n<p class=\"lead\">" +
            "Threshold, noise and rho from a recording of normal operation, starting from " + EscapeHtml(config) +
            ".</p>\n<div class=\"tiles\">");
  const auto tile = [&page](const std::string& value, const std::string& what) {
    page.Html("<div class=\"tile after\"><b>" + value + "</b><span>" + what + "</span></div>");
  };
  tile(NumberText(c.threshold.threshold, 3), "threshold, noise scales");
  for (const ModeNoise& noise : c.noise)
    if (noise.calibrated)
      tile(NumberText(noise.laws[noise.chosen].noise.std, 4) + " <small>" + EscapeHtml(unit) + "</small>",
           "scale of the " + EscapeHtml(Name(noise.laws[noise.chosen].noise.kind)) + " noise, mode " +
               EscapeHtml(noise.mode));
  tile(NumberText(c.settings.forgetting.rho, 3), "rho");
  tile(plots::PercentText(c.threshold.measured_rate),
       "of " + std::to_string(c.scores.size()) + " packs reach the threshold; " +
           NumberText(100.0 * c.false_modifications, 3) + " % were allowed");
  page.Html("</div>\n");
  if (!c.notes.empty()) {
    page.Html("<div class=\"note\">");
    for (const std::string& note : c.notes) page.Html("<p>" + EscapeHtml(note) + "</p>");
    page.Html("</div>\n");
  }
  for (const ModeNoise& noise : c.noise) AddNoise(noise, unit, &page);
  AddThreshold(c, &page);
  AddRho(c, &page);
  page.Html("</main>\n");
  return page.ToString();
}

std::string SummaryText(const Calibration& c, const std::string& unit) {
  std::ostringstream out;
  support::TextTable table({"mode", "noise", "scale", "unit", "shape", "packs", "ahead of gaussian, nats"});
  for (const ModeNoise& noise : c.noise) {
    if (!noise.calibrated) continue;
    const LawScore& law = noise.laws[noise.chosen];
    table.AddRow({noise.mode, std::string(Name(law.noise.kind)), Significant(law.noise.std, 4), unit, Shape(law.noise),
                  std::to_string(noise.packs), Significant(law.heldout - noise.laws.front().heldout, 3)});
  }
  out << table.ToString() << "rho " << Significant(c.settings.forgetting.rho, 3) << "; threshold "
      << Significant(c.threshold.threshold, 4) << ", reached by " << Significant(100.0 * c.threshold.measured_rate, 3)
      << " % of " << c.scores.size() << " packs (" << Significant(100.0 * c.false_modifications, 3)
      << " % allowed); noise converged after " << c.noise_runs << " runs\n";
  for (const std::string& note : c.notes) out << "note: " << note << '\n';
  return out.str();
}

}  // namespace armcmc::calibrate
