#include <algorithm>
#include <cmath>
#include <sstream>

#include "armcmc/gap_bench/report.hpp"
#include "armcmc/gap_bench/summary.hpp"
#include "armcmc/plots/html.hpp"
#include "armcmc/plots/page.hpp"

namespace armcmc::gap_bench {
namespace {

using plots::EscapeHtml;

std::string Cell(const std::string& text) { return "<td class=\"num\">" + EscapeHtml(text) + "</td>"; }

void AddGates(const std::vector<Outcome>& outcomes, plots::Page* page) {
  page->Html(
      "<section class=\"card\"><h2>Gates</h2>\n<div class=\"scroll\"><table><tr><th>stratum</th><th>metric</th>"
      "<th class=\"num\">value</th><th class=\"num\">limit</th><th class=\"num\">cases</th><th></th></tr>\n");
  for (const Gate& gate : Gates(outcomes))
    page->Html("<tr><td>" + EscapeHtml(gate.stratum) + "</td><td>" + EscapeHtml(gate.metric) + "</td>" +
               Cell(plots::NumberText(gate.value, 3)) +
               Cell((gate.at_least ? "≥ " : "≤ ") + plots::NumberText(gate.limit, 3)) + Cell(std::to_string(gate.n)) +
               "<td><span class=\"chip small " + (gate.passed() ? "good\">passed" : "doubt\">failed") +
               "</span></td></tr>\n");
  page->Html("</table></div></section>\n");
}

void AddCounts(const std::vector<Outcome>& outcomes, plots::Page* page) {
  std::string head = "<tr><th>stratum</th><th>group</th><th class=\"num\">cases</th>";
  for (int g = 0; g < kNumGrades; ++g)
    head += std::string("<th class=\"num\">") + GradeName(static_cast<Grade>(g)) + "</th>";
  page->Html("<section class=\"card\"><h2>Answers</h2>\n<div class=\"scroll\"><table>" + head + "</tr>\n");
  for (const Row& row : Rows(outcomes)) {
    std::string cells = "<tr><td>" + EscapeHtml(row.stratum) + "</td><td>" + EscapeHtml(row.group) + "</td>" +
                        Cell(std::to_string(row.counted()));
    for (int g = 0; g < kNumGrades; ++g) cells += Cell(std::to_string(row.of(static_cast<Grade>(g))));
    page->Html(cells + "</tr>\n");
  }
  page->Html(
      "</table></div>\n<p class=\"soft\">right: the truth and nothing else (data without an effect: nothing; an effect "
      "outside the catalogue: unnamed). tie: several sets, the truth among them. family: another effect of the same "
      "family. partial: one of two. wrong: a false name. not shown: the effect that was not found leaves no trace in "
      "the diagnosed part. not made: the plant cannot hide that effect so "
      "strongly in that motion. The last two do not count.</p></section>\n");
}

/// A map whose axes count what the lists below it name.
void AddConfusion(const std::vector<Outcome>& outcomes, plots::Page* page) {
  const Confusion confusion = Confuse(outcomes);
  plots::HeatMap map;
  map.x_title = "answer, number in the list";
  map.y_title = "truth, number in the list";
  map.value_title = "share of the truth's cases";
  map.height = 460;
  for (std::size_t c = 0; c <= confusion.answers.size(); ++c) map.x_edges.push_back(static_cast<double>(c) + 0.5);
  for (std::size_t r = 0; r <= confusion.names.size(); ++r) map.y_edges.push_back(static_cast<double>(r) + 0.5);
  for (const std::vector<int>& row : confusion.count) {
    int n = 0;
    for (const int count : row) n += count;
    for (const int count : row) map.value.push_back(n > 0 ? static_cast<double>(count) / n : std::nan(""));
  }
  std::string list = "<p class=\"soft\">";
  for (std::size_t c = 0; c < confusion.answers.size(); ++c)
    list += (c > 0 ? " · " : "") + std::to_string(c + 1) + " " + EscapeHtml(confusion.answers[c]);
  page->Html("<section class=\"card\"><h2>Truth against answer</h2>\n");
  page->Chart(map, "One hidden effect, R ≥ 0.3. The diagonal is right and alone.");
  page->Html(list + "</p></section>\n");
}

void AddReliability(const std::vector<Outcome>& outcomes, plots::Page* page) {
  const Calibration calibration = Calibrate(outcomes);
  plots::XyChart chart;
  chart.x_title = "printed probability";
  chart.y_title = "share that came true";
  plots::Series ideal{"ideal", plots::Role::kOther, {0.0, 1.0}, {0.0, 1.0}, {}, {}};
  plots::Series found{"found", plots::Role::kMeasured, {}, {}, {}, {}};
  for (const Bin& bin : calibration.bins) {
    if (bin.n == 0) continue;
    // Wilson's 95 % interval.
    constexpr double z = 1.96;
    const double n = bin.n, centre = (bin.right + z * z / (2.0 * n)) / (1.0 + z * z / n);
    const double half = z * std::sqrt(bin.right * (1.0 - bin.right) / n + z * z / (4.0 * n * n)) / (1.0 + z * z / n);
    found.x.push_back(bin.printed);
    found.y.push_back(bin.right);
    found.low.push_back(std::min(centre - half, bin.right));
    found.high.push_back(std::max(centre + half, bin.right));
  }
  chart.series = {ideal, found};
  page->Html("<section class=\"card\"><h2>Printed probabilities</h2>\n");
  page->Chart(chart, "What the tool holds most probable, all strata together: expected calibration error " +
                         plots::FixedText(calibration.error, 3) + " over " + std::to_string(calibration.n) +
                         " cases. The band is the 95 % interval of the share.");
  page->Html("</section>\n");
}

void AddClosure(const std::vector<Outcome>& outcomes, plots::Page* page) {
  constexpr int kBars = 22;
  constexpr double kLow = 0.8, kWidth = 0.01;
  std::vector<int> count(kBars, 0);
  for (const double closure : Closures(outcomes))
    ++count[static_cast<std::size_t>(std::clamp(static_cast<int>((closure - kLow) / kWidth), 0, kBars - 1))];
  plots::XyChart chart;
  chart.x_title = "share of the gap that is closed on held-out data";
  chart.y_title = "cases";
  plots::Series bars{"cases", plots::Role::kAfter, {}, {}, {}, {}};
  for (int b = 0; b < kBars; ++b)
    for (const double edge : {0.0, 0.999}) {
      bars.x.push_back(kLow + kWidth * (b + edge));
      bars.y.push_back(count[static_cast<std::size_t>(b)]);
    }
  if (!Closures(outcomes).empty()) chart.series = {bars};
  page->Html("<section class=\"card\"><h2>The gap, closed</h2>\n");
  page->Chart(chart,
              "Found effects with R ≥ 1, on the last 30 % of each recording, which had no part in the diagnosis. The "
              "first bar holds all that is lower, the last all that is higher.");
  page->Html("</section>\n");
}

void AddOnsets(const Onsets& onsets, plots::Page* page) {
  if (onsets.n == 0) return;
  const auto percent = [](double share) { return plots::FixedText(100.0 * share, 0) + " %"; };
  page->Html("<section class=\"card\"><h2>Onsets</h2>\n<p>Of " + std::to_string(onsets.n) +
             " effects that begin during the recording and were found, " + percent(onsets.within_200_ms) +
             " were dated within 0.2 s and " + percent(onsets.within_20_ms) +
             " within 20 ms of the times at which the data cannot tell the onset apart (median " +
             plots::NumberText(onsets.median_s, 2) + " s, 90 % quantile " + plots::NumberText(onsets.quantile90_s, 2) +
             " s). Within 0.2 s of the true onset, at which an effect need not leave a trace yet: " +
             percent(onsets.off_within_200_ms) + ".</p></section>\n");
}

void AddFailures(const std::vector<Outcome>& outcomes, plots::Page* page) {
  page->Html("<section class=\"card\"><h2>Wrong and failed</h2>\n<ul class=\"plain\">\n");
  for (const Outcome& o : outcomes)
    if (o.grade == Grade::kWrong || o.grade == Grade::kFailed)
      page->Html("<li class=\"mono\">" + EscapeHtml(Line(o)) + "</li>\n");
  page->Html("</ul></section>\n");
}

}  // namespace

std::string Html(const std::vector<Outcome>& outcomes, std::uint64_t seed) {
  plots::Page page("Benchmark of the gap workflow");
  page.Html("<main>\n<h1>Benchmark of the gap workflow</h1>\n<p class=\"lead\">" + std::to_string(outcomes.size()) +
            " recordings with effects that only a sealed file knew, seed " + std::to_string(seed) + ".</p>\n");
  AddGates(outcomes, &page);
  AddConfusion(outcomes, &page);
  AddReliability(outcomes, &page);
  AddClosure(outcomes, &page);
  AddOnsets(LocateOnsets(outcomes), &page);
  AddCounts(outcomes, &page);
  AddFailures(outcomes, &page);
  page.Html("</main>\n");
  return page.ToString();
}

}  // namespace armcmc::gap_bench
