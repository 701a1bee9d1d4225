// The evidence for the verdict: where the error occurs, and the candidate explanations.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "armcmc/plots/html.hpp"
#include "report_sections.hpp"
#include "report_words.hpp"

namespace armcmc::gap {
namespace {

using plots::EscapeHtml;
using plots::NumberText;
using plots::PercentText;

constexpr std::size_t kMaxRows = 12;

/// One line of the ranking.
struct Explanation {
  std::string title;  // HTML
  const char* bar = "";
  double probability = 0.0;
  const CandidateScore* score = nullptr;
};

bool IsAmong(const std::vector<std::vector<std::string>>& sets, const std::vector<std::string>& set) {
  return std::find(sets.begin(), sets.end(), set) != sets.end();
}

std::vector<Explanation> Explanations(const Result& result) {
  std::vector<Explanation> out;
  Explanation nothing{"<i>Nothing is missing</i>", "good", result.probability_none, nullptr};
  const CandidateScore* best = nullptr;
  for (const CandidateScore& c : result.candidates)
    if (!c.effects.empty() && (best == nullptr || c.probability > best->probability)) best = &c;
  for (const CandidateScore& c : result.candidates) {
    if (c.effects.empty()) {
      nothing.score = &c;
      continue;
    }
    const bool held = (result.verdict == Verdict::kNamed && &c == best);
    out.push_back({EscapeHtml(EffectTitles(c.effects)),
                   held                                       ? "top"
                   : IsAmong(result.ambiguous_set, c.effects) ? "doubt"
                                                              : "",
                   c.probability, &c});
  }
  out.push_back(nothing);
  out.push_back({"<i>Something that is not in the catalogue</i>", "unknown", result.probability_unnamed, nullptr});
  std::stable_sort(out.begin(), out.end(), [](const Explanation& a, const Explanation& b) {
    return (std::isfinite(a.probability) ? a.probability : -1.0) >
           (std::isfinite(b.probability) ? b.probability : -1.0);
  });
  return out;
}

/// Keeps the most probable rows, and always the two that are not effects.
void Shorten(std::vector<Explanation>* rows, std::size_t* left_out, double* left_out_probability) {
  std::vector<Explanation> kept;
  for (const Explanation& row : *rows) {
    const bool special = row.score == nullptr || row.score->effects.empty();
    if (special || kept.size() < kMaxRows) {
      kept.push_back(row);
    } else {
      ++*left_out;
      if (std::isfinite(row.probability)) *left_out_probability += row.probability;
    }
  }
  *rows = kept;
}

std::string ScoreCells(const CandidateScore* score) {
  if (score == nullptr)
    return "<td class=\"num middle\"></td><td class=\"num middle\"></td><td class=\"num middle\"></td>";
  return "<td class=\"num middle\">" + (score->effects.empty() ? "" : PercentText(score->closed_fraction)) +
         "</td><td class=\"num middle\">" + plots::FixedText(score->heldout_score, 1) +
         "</td><td class=\"num middle\">" + plots::FixedText(score->log_evidence, 1) + "</td>";
}

}  // namespace

void AddCandidates(const Result& result, plots::Page* page) {
  std::vector<Explanation> rows = Explanations(result);
  std::size_t left_out = 0;
  double left_out_probability = 0.0;
  Shorten(&rows, &left_out, &left_out_probability);
  std::ostringstream out;
  out << "<section class=\"card\" id=\"candidates\">\n<h2>Candidate explanations</h2>\n<p class=\"soft\">The length of "
         "a bar is the probability of the explanation. "
      << (result.ambiguous_set.empty() ? "" : "Amber: the data cannot distinguish these. ")
      << "The score is the log predictive density of blocks left out of each fit, relative to the base model; 3 nats "
         "are odds of 20 to 1.</p>\n"
         "<div class=\"scroll\"><table>\n<tr><th>explanation</th><th></th><th class=\"num\">probability</th>"
         "<th class=\"num\">gap closed</th><th class=\"num\">score, nats</th><th class=\"num\">log evidence, "
         "nats</th></tr>\n";
  for (const Explanation& row : rows) {
    const double share = std::isfinite(row.probability) ? std::clamp(row.probability, 0.0, 1.0) : 0.0;
    out << "<tr><td>" << row.title << "</td><td class=\"wide middle\"><div class=\"bar\"><i class=\"" << row.bar
        << "\" style=\"width:" << plots::FixedText(100.0 * share, 2) << "%\"></i></div></td><td class=\"num middle\">"
        << PercentText(row.probability) << "</td>" << ScoreCells(row.score) << "</tr>\n";
  }
  out << "</table></div>\n";
  if (left_out > 0)
    out << "<p class=\"soft\">" << left_out << " further candidates were tested; their total probability is "
        << PercentText(left_out_probability) << ". result.json lists all of them.</p>\n";
  out << "</section>\n";
  page->Html(out.view());
}

void AddWhere(const Result& result, plots::Page* page) {
  page->Html("<section class=\"card\" id=\"where\">\n<h2>Where model and data disagree</h2>\n");
  const MapFigure& map = result.figures.where;
  if (!map.value.empty())
    page->Chart(
        plots::HeatMap{map.x_title, map.y_title, map.value_title, map.x_edges, map.y_edges, map.value},
        "Excess error of the base model: the darker a cell, the larger the error; hatched cells contain no data.");
  std::ostringstream out;
  if (result.where.empty()) {
    out << "<p>No quantity predicts the error significantly.</p>\n";
  } else {
    out << "<div class=\"scroll\"><table>\n<tr><th>the error depends on</th><th>region</th><th class=\"num\">share of "
           "the excess error there</th><th class=\"num\">effect size, share of the noise variance</th><th "
           "class=\"num\">p-value</th></tr>\n";
    for (const Where& w : result.where)
      out << "<tr><td>" << EscapeHtml(w.feature) << "</td><td>"
          << (w.region.empty() ? "everywhere" : EscapeHtml(w.region)) << "</td><td class=\"num\">"
          << PercentText(w.share_of_excess) << "</td><td class=\"num\">" << NumberText(w.effect_size, 2)
          << "</td><td class=\"num\">" << (w.p_value < 1e-4 ? "< 0.0001" : NumberText(w.p_value, 2)) << "</td></tr>\n";
    out << "</table></div>\n<p class=\"soft\">Effect size: the predictable part of the error on blocks left out, "
           "relative to the noise variance.</p>\n";
  }
  out << "</section>\n";
  page->Html(out.view());
}

}  // namespace armcmc::gap
