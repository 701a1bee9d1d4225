// The ladder: the named effects in order, the error after each, and the remainder.
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

std::string Names(const LadderRung& rung) {
  std::string names;
  for (const std::string& name : rung.effects)
    names += (names.empty() ? "<b>" : " <span class=\"soft\">or</span> <b>") + EscapeHtml(EffectTitle(name)) + "</b>";
  return names;
}

void AddRung(const LadderRung& rung, const std::string& unit, std::ostream& out) {
  out << "<tr><td>+ " << Names(rung);
  if (rung.provisional) out << " <span class=\"chip small doubt\">few events</span>";
  for (const std::string& parameter : rung.parameters)
    out << "<br><span class=\"soft mono\">" << EscapeHtml(parameter) << "</span>";
  out << "</td><td class=\"num\">" << NumberText(rung.heldout_error, 3) << ' ' << EscapeHtml(unit)
      << "</td><td class=\"num\">" << PercentText(rung.closed_fraction) << "</td><td class=\"num\">"
      << NumberText(rung.remainder_ratio, 3) << "</td><td class=\"num\">" << PercentText(rung.probability)
      << "</td></tr>\n";
}

void AddRemainder(const Result& result, std::ostream& out) {
  if (result.complete) {
    out << "<p>No misfit remains: a flexible function of all quantities explains nothing further, and the error of the "
           "model equals the difference between neighbouring samples.</p>\n";
    return;
  }
  out << "<p><b>" << PercentText(result.remainder.share)
      << "</b> of the squared error beyond the noise remains unexplained, and no applicable effect of the catalogue "
         "explains it.";
  if (!result.remainder.where.empty()) {
    const Where& w = result.remainder.where.front();
    out << " The largest part (" << PercentText(w.share_of_excess) << ") is where: " << EscapeHtml(w.region) << ".";
  }
  out << "</p>\n";
  if (result.remainder.sparse.empty()) return;
  out << "<p class=\"soft\">Approximated by a sum of simple terms:";
  for (const SparseTerm& term : result.remainder.sparse)
    out << " <span class=\"mono\">" << (term.coefficient < 0.0 ? "− " : "+ ")
        << NumberText(std::fabs(term.coefficient), 3) << "·" << EscapeHtml(term.expression) << "</span>";
  out << ". This describes the remainder; it does not identify its cause.</p>\n";
}

void AddStretches(const Result& result, std::ostream& out) {
  if (result.gap.stretches.empty()) return;
  out << "<h3>Held-out segments</h3>\n<div class=\"scroll\"><table>\n<tr><th>from, s</th><th>until, "
         "s</th><th class=\"num\">samples</th><th class=\"num\">error before</th><th class=\"num\">after</th></tr>\n";
  for (const SegmentFit& s : result.gap.stretches)
    out << "<tr><td>" << NumberText(s.from_s, 4) << "</td><td>" << NumberText(s.until_s, 4) << "</td><td class=\"num\">"
        << s.samples << "</td><td class=\"num\">" << NumberText(s.rmse_before, 3) << "</td><td class=\"num\">"
        << NumberText(s.rmse_after, 3) << ' ' << EscapeHtml(result.gap.unit) << "</td></tr>\n";
  out << "</table></div>\n";
}

void AddPublished(const Result& result, std::ostream& out) {
  if (result.published.empty()) return;
  out << "<h3>Published results on these data</h3>\n<div class=\"scroll\"><table>\n<tr><th>what</th><th "
         "class=\"num\">value</th><th>source</th></tr>\n";
  for (const PublishedFigure& p : result.published)
    out << "<tr><td>" << EscapeHtml(p.what) << "</td><td class=\"num\">" << NumberText(p.value, 3) << "</td><td>"
        << EscapeHtml(p.source) << "</td></tr>\n";
  out << "</table></div>\n<p class=\"soft\">This analysis, on the held-out rows: rms error "
      << NumberText(result.gap.before.rmse, 3) << " → " << NumberText(result.gap.after.rmse, 3) << ' '
      << EscapeHtml(result.gap.unit) << ", relative error " << PercentText(result.relative_before) << " → "
      << PercentText(result.relative_after) << ".</p>\n";
}

}  // namespace

void AddLadder(const Result& result, plots::Page* page) {
  if (result.ladder.empty() && result.published.empty()) return;
  std::ostringstream out;
  out << "<section class=\"card\" id=\"ladder\">\n<h2>Named effects, step by step</h2>\n<p class=\"soft\">After each "
         "effect, the extended model is refitted and the residual is examined again. Errors are on held-out "
         "data.</p>\n<div class=\"scroll\"><table>\n<tr><th>model</th><th "
         "class=\"num\">error (rms)</th><th class=\"num\">gap closed</th><th class=\"num\">error of the fit relative "
         "to the noise</th><th class=\"num\">probability</th></tr>\n<tr><td>base model</td><td class=\"num\">"
      << NumberText(result.gap.before.rmse, 3) << ' ' << EscapeHtml(result.gap.unit)
      << "</td><td class=\"num\"></td><td class=\"num\">" << NumberText(result.gap.gap_ratio, 3)
      << "</td><td></td></tr>\n";
  for (const LadderRung& rung : result.ladder) AddRung(rung, result.gap.unit, out);
  out << "</table></div>\n";
  AddStretches(result, out);
  AddRemainder(result, out);
  AddPublished(result, out);
  out << "</section>\n";
  page->Html(out.view());
}

}  // namespace armcmc::gap
