// The top of the page: the verdict, the gap, the added effects, the open questions.
#include <algorithm>
#include <cmath>
#include <filesystem>
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

struct VerdictWords {
  const char* chip_class;
  const char* chip;
  const char* consequence;
};

VerdictWords VerdictWordsOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kNamed:
      return {"named", "Named", "All other applicable effects of the catalogue were tested and rejected."};
    case Verdict::kAmbiguous:
      return {"doubt", "Ambiguous",
              "Several explanations fit these data equally well. The experiment below would distinguish them."};
    case Verdict::kUnnamed:
      return {"unknown", "Cause unknown",
              "The model is missing an effect that is not in the catalogue. Nothing was added to the model; this page "
              "shows where the misfit occurs and describes its form."};
    case Verdict::kNone: break;
  }
  return {"good", "Nothing missing",
          "No effect improves the prediction of data to which it was not fitted. Nothing was added."};
}

std::string SentenceOf(const Result& result) {
  if (!result.sentence.empty()) return EscapeHtml(result.sentence);
  std::vector<std::string> names;
  for (const EffectFinding& e : result.effects) names.push_back(e.name);
  switch (result.verdict) {
    case Verdict::kNamed: return "The model is missing " + EscapeHtml(EffectTitles(names)) + ".";
    case Verdict::kAmbiguous:
      return std::to_string(result.ambiguous_set.size()) + " explanations fit the misfit equally well.";
    case Verdict::kUnnamed: return "The model is missing an effect that is not in the catalogue.";
    case Verdict::kNone: break;
  }
  return "The model explains the data down to the noise.";
}

/// The probability of the verdict, in words.
std::string ProbabilityOf(const Result& result) {
  switch (result.verdict) {
    case Verdict::kNone: return "Probability that nothing is missing: " + PercentText(result.probability_none);
    case Verdict::kUnnamed:
      return "Probability that the cause is not in the catalogue: " + PercentText(result.probability_unnamed);
    case Verdict::kAmbiguous: {
      double sum = 0.0;
      for (const CandidateScore& c : result.candidates)
        if (std::find(result.ambiguous_set.begin(), result.ambiguous_set.end(), c.effects) !=
            result.ambiguous_set.end())
          sum += c.probability;
      return "Probability that it is one of these: " + PercentText(sum);
    }
    case Verdict::kNamed: break;
  }
  std::string out = "Probability: ";
  for (std::size_t i = 0; i < result.effects.size(); ++i)
    out += (i > 0 ? ", " : "") +
           (result.effects.size() > 1 ? EscapeHtml(EffectTitle(result.effects[i].name)) + " " : std::string()) +
           PercentText(result.effects[i].probability);
  return out;
}

std::string Tile(const char* kind, double value, const std::string& unit, const std::string& words) {
  return std::string("<div class=\"tile ") + kind + "\"><b>" + NumberText(value, 3) + " <small>" + EscapeHtml(unit) +
         "</small></b><span>" + words + "</span></div>\n";
}

std::string Width(double share) {
  return FixedText(100.0 * (std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0.0), 2) + "%";
}

void AddBars(const Result& result, std::ostream& out) {
  const GapSummary& gap = result.gap;
  double longest = 0.0;
  for (const double v : {gap.before.rmse, HasAfter(result) ? gap.after.rmse : 0.0, gap.noise_floor})
    if (std::isfinite(v)) longest = std::max(longest, v);
  if (!(longest > 0.0)) return;
  const auto row = [&](const char* kind, const char* label, double value) {
    out << "<div class=\"row\"><span>" << label << "</span><div class=\"track\"><div class=\"fill " << kind
        << "\" style=\"width:" << Width(value / longest) << "\"></div>";
    if (std::isfinite(gap.noise_floor))
      out << "<div class=\"floor\" style=\"left:" << Width(gap.noise_floor / longest) << "\"></div>";
    out << "</div></div>\n";
  };
  out << "<div class=\"bars\">\n";
  row("before", HasAfter(result) ? "before" : "model", gap.before.rmse);
  if (HasAfter(result)) row("after", "after", gap.after.rmse);
  out << "</div>\n";
}

/// The quantity on which the error depends most, in one line.
void AddPlace(const Result& result, std::ostream& out) {
  if (result.where.empty() || result.verdict == Verdict::kNone) return;
  const Where& w = result.where.front();
  out << "<p>The error depends most on <b>" << EscapeHtml(w.feature) << "</b>";
  if (!w.region.empty())
    out << "; " << PercentText(w.share_of_excess) << " of the excess error occurs where: " << EscapeHtml(w.region);
  out << ".</p>\n";
}

void AddGap(const Result& result, std::ostream& out) {
  const GapSummary& gap = result.gap;
  out << "<section class=\"card\" id=\"gap\">\n<h2>The gap</h2>\n<p class=\"soft\">Prediction error (root mean square) "
         "on held-out data.</p>\n<div class=\"tiles\">\n"
      << Tile("before", gap.before.rmse, gap.unit, HasAfter(result) ? "before" : "base model");
  if (HasAfter(result)) out << Tile("after", gap.after.rmse, gap.unit, "after");
  out << Tile("floor", gap.noise_floor, gap.unit, "noise floor") << "</div>\n";
  AddBars(result, out);
  out << "<p class=\"soft\">Dashed line: the noise floor, the lower limit for any model.</p>\n";
  if (HasAfter(result)) {
    out << "<p><b>" << PercentText(gap.closed_fraction) << "</b> of the explainable squared error is removed";
    if (std::isfinite(gap.closed_low) && std::isfinite(gap.closed_high) && gap.closed_high > gap.closed_low)
      out << " (95 % interval " << FixedText(100.0 * gap.closed_low, 1) << " to "
          << FixedText(100.0 * gap.closed_high, 1) << " %)";
    out << ".";
    if (!gap.control_effects.empty()) {
      const std::string other = EscapeHtml(InSentence(gap.control_effects));
      out << (result.verdict == Verdict::kAmbiguous
                  ? " The alternative (" + other + ") closes "
                  : " For comparison, the second-best candidate (" + other + ") closes ")
          << PercentText(gap.control_closed_fraction) << ".";
    }
    out << "</p>\n";
  } else if (std::isfinite(gap.gap_ratio)) {
    out << "<p>The misfit of the model, with its parameters refitted, is <b>" << NumberText(gap.gap_ratio, 2)
        << " times</b> the noise (root mean square).</p>\n";
  }
  AddPlace(result, out);
  out << "</section>\n";
}

void AddEffect(const EffectFinding& effect, std::ostream& out) {
  const EffectWords words = WordsOf(effect.name);
  out << "<h3>" << EscapeHtml(EffectTitle(effect.name));
  if (effect.approximate) out << " <span class=\"chip small doubt\">formula approximate</span>";
  if (effect.provisional) out << " <span class=\"chip small doubt\">provisional</span>";
  out << "</h3>\n";
  if (!words.formula.empty()) out << "<p class=\"formula\">" << words.formula << "</p>\n";
  if (!words.meaning.empty()) out << "<p class=\"soft\">" << words.meaning << "</p>\n";
  out << "<dl class=\"facts\">\n";
  for (const ParameterEstimate& p : effect.parameters)
    out << "<dt>" << EscapeHtml(p.name) << "</dt><dd><b>" << MeanText(p) << "</b> <span class=\"soft\">("
        << (p.sd > 0.0 && p.confounded_with.empty() ? "95 %: " : "") << IntervalText(p) << ")</span></dd>\n";
  out << "<dt>Acts</dt><dd>" << WhenText(effect.when) << "</dd>\n";
  if (!effect.family.empty()) out << "<dt>Family</dt><dd>" << EscapeHtml(effect.family) << "</dd>\n";
  out << "<dt>Probability</dt><dd>" << PercentText(effect.probability) << "</dd>\n</dl>\n";
  if (effect.approximate)
    out << "<p class=\"soft\">The family is identified, but the formula is approximate: a flexible function of the "
           "same variables fits better.</p>\n";
  if (effect.provisional)
    out << "<p class=\"soft\">Provisional: the effect acts in too few separate events to be validated on data left "
           "out.</p>\n";
}

/// Sums and products that the data determine of parameters that they do not determine one by one.
void AddDetermined(const Result& result, std::ostream& out) {
  if (result.determined.empty()) return;
  out << "<h3>Parameters that these data do not separate</h3>\n<p class=\"soft\">A change of one of them can be "
         "compensated by others without any effect on the prediction, so that their values in the model are one choice "
         "of "
         "many. The data determine these combinations:</p>\n<ul class=\"plain\">\n";
  for (const Combination& c : result.determined) {
    const ParameterEstimate as_one{"", c.unit, c.value, c.sd};
    out << "<li><span class=\"mono\">" << EscapeHtml(c.text) << "</span> = <b>" << MeanText(as_one)
        << "</b> <span class=\"soft\">(95 %: " << IntervalText(as_one) << ")</span></li>\n";
  }
  out << "</ul>\n";
}

/// The most probable candidates that were not added.
void AddNearest(const Result& result, std::ostream& out) {
  std::vector<const CandidateScore*> nearest;
  for (const CandidateScore& c : result.candidates)
    if (!c.effects.empty()) nearest.push_back(&c);
  if (nearest.empty()) return;
  nearest.resize(std::min<std::size_t>(nearest.size(), 3));
  out << "<p class=\"soft\">The closest candidates:</p>\n<ul class=\"plain\">\n";
  for (const CandidateScore* c : nearest)
    out << "<li>" << EscapeHtml(EffectTitles(c->effects)) << ": closes " << PercentText(c->closed_fraction)
        << " of the gap, probability " << PercentText(c->probability) << "</li>\n";
  out << "</ul>\n";
}

void AddSparse(const Result& result, std::ostream& out) {
  if (result.sparse.empty()) return;
  out << "<h3>Description of the misfit</h3>\n<p class=\"soft\">The shortest sum of simple terms that predicts the "
         "misfit; it does not identify the cause. Shares of the gap are on data left out of the fit.</p>\n"
         "<div class=\"scroll\"><table>\n<tr><th>term</th><th class=\"num\">coefficient (SI)</th>"
         "<th class=\"num\">share of the gap</th></tr>\n";
  for (const SparseTerm& term : result.sparse)
    out << "<tr><td class=\"mono\">" << EscapeHtml(term.expression) << "</td><td class=\"num\">"
        << NumberText(term.coefficient, 3) << "</td><td class=\"num\">" << PercentText(term.share) << "</td></tr>\n";
  out << "</table></div>\n";
}

void AddNothing(const Result& result, std::ostream& out) {
  out << "<p>Nothing; the model is unchanged. "
      << (result.verdict == Verdict::kUnnamed
              ? "A wrong effect would distort the parameters and hide the cause."
              : "Every applicable effect of the catalogue was tested; none improves the prediction enough.")
      << "</p>\n";
  AddNearest(result, out);
}

void AddEffects(const Result& result, std::ostream& out) {
  out << "<section class=\"card\" id=\"added\">\n<h2>What was added</h2>\n";
  if (!HasAfter(result)) AddNothing(result, out);
  if (result.verdict == Verdict::kAmbiguous && HasAfter(result))
    out << "<p class=\"soft\">The most probable of the alternatives, so that the model predicts well; the data do not "
           "confirm it.</p>\n";
  for (const EffectFinding& effect : result.effects) AddEffect(effect, out);
  AddDetermined(result, out);
  AddSparse(result, out);
  if (!result.model_file.empty())
    out << "<p class=\"soft\">The extended model is in <code>" << EscapeHtml(result.model_file)
        << "</code>, for the estimator, the replay and the simulated plant.</p>\n";
  out << "</section>\n";
}

}  // namespace

void AddHeadline(const Result& result, plots::Page* page) {
  const VerdictWords words = VerdictWordsOf(result.verdict);
  std::ostringstream out;
  out << "<header>\n<div class=\"top\"><span class=\"over\">Gap report</span><span class=\"chip " << words.chip_class
      << "\">" << words.chip << "</span><span class=\"soft\">" << EscapeHtml(result.model) << " on "
      << EscapeHtml(std::filesystem::path(result.data_file).filename().string()) << "</span></div>\n<h1>"
      << SentenceOf(result) << "</h1>\n<p class=\"lead\"><b>" << ProbabilityOf(result) << ".</b> " << words.consequence
      << "</p>\n<nav aria-label=\"Contents\"><a href=\"#gap\">Gap</a><a href=\"#time\">Over time</a>"
         "<a href=\"#where\">Where</a><a href=\"#candidates\">Candidates</a><a href=\"#parameters\">Parameters</a>"
         "<a href=\"#quality\">Quality</a><a href=\"#limits\">Limits</a><a href=\"#provenance\">Provenance</a></nav>\n"
         "</header>\n";
  page->Html(out.view());
}

void AddGapAndEffects(const Result& result, plots::Page* page) {
  std::ostringstream out;
  out << "<div class=\"grid\">\n";
  AddGap(result, out);
  AddEffects(result, out);
  out << "</div>\n";
  page->Html(out.view());
}

void AddOpenQuestions(const Result& result, plots::Page* page) {
  std::vector<std::vector<std::string>> open = result.ambiguous_set;
  // A tie on a lower rung, below effects that were named alone.
  for (std::size_t r = 0; r < result.ladder.size() && result.ambiguous_set.empty(); ++r)
    if (result.ladder[r].effects.size() > 1)
      for (const std::string& effect : result.ladder[r].effects) open.push_back({effect});
  if (open.empty()) return;
  const Experiment& experiment = result.separate_by;
  std::ostringstream out;
  out << "<section class=\"card\" id=\"separate\">\n<h2>Effects that these data cannot distinguish</h2>\n<ul "
         "class=\"plain\">\n";
  for (const auto& effects : open) out << "<li>" << EscapeHtml(EffectTitles(effects)) << "</li>\n";
  out << "</ul>\n";
  if (!experiment.words.empty() || !experiment.scenario_file.empty()) {
    out << "<h3>Proposed experiment</h3>\n<p>" << EscapeHtml(experiment.words) << "</p>\n";
    if (std::isfinite(experiment.nats) && experiment.nats > 0.0)
      out << "<p class=\"soft\">Expected evidence between the closest pair: " << NumberText(experiment.nats, 2)
          << " nats (3 nats are odds of 20 to 1).</p>\n";
    if (!experiment.scenario_file.empty())
      out << "<p class=\"soft\">Ready to run: <code>" << EscapeHtml(experiment.scenario_file) << "</code></p>\n";
  }
  page->Html(out.view());
  if (!experiment.course.x.empty()) {
    plots::XyChart chart;
    chart.x_title = "time, s";
    chart.y_title = experiment.course_title;
    chart.height = 200;
    chart.series.push_back({"proposed", plots::Role::kEffect, experiment.course.x, experiment.course.y, {}, {}});
    page->Chart(chart, "The proposed motion.");
  }
  page->Html("</section>\n");
}

}  // namespace armcmc::gap
