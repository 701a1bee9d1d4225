#include <cmath>
#include <sstream>

#include "armcmc/plots/html.hpp"
#include "armcmc/plots/page.hpp"
#include "armcmc/tables/plants/registry.hpp"
#include "armcmc/tables/report.hpp"
#include "figures.hpp"

namespace armcmc::tables {
namespace {

using plots::EscapeHtml;
using plots::NumberText;

/// A table; the smallest finite value of each marked column, over the rows that compete, is bold.
class HtmlTable {
 public:
  explicit HtmlTable(std::vector<std::string> header) : header_(std::move(header)) {}
  void Add(const std::string& label, const std::vector<double>& values, bool competes) {
    rows_.push_back({label, values, competes});
  }
  [[nodiscard]] std::string ToString(std::size_t judged) const {
    std::ostringstream out;
    out << "<div class=\"scroll\"><table><tr>";
    for (std::size_t i = 0; i < header_.size(); ++i)
      out << (i == 0 ? "<th>" : "<th class=\"num\">") << EscapeHtml(header_[i]) << "</th>";
    out << "</tr>\n";
    for (const Line& row : rows_) {
      out << "<tr><td>" << EscapeHtml(row.label) << "</td>";
      for (std::size_t i = 0; i < row.values.size(); ++i) {
        const bool best = i < judged && row.competes && row.values[i] <= Best(i);
        out << "<td class=\"num\">" << (best ? "<b>" : "") << NumberText(row.values[i], 3) << (best ? "</b>" : "")
            << "</td>";
      }
      out << "</tr>\n";
    }
    out << "</table></div>\n";
    return out.str();
  }

 private:
  struct Line {
    std::string label;
    std::vector<double> values;
    bool competes;
  };
  [[nodiscard]] double Best(std::size_t column) const {
    double best = HUGE_VAL;
    for (const Line& row : rows_)
      if (row.competes && std::isfinite(row.values[column])) best = std::fmin(best, row.values[column]);
    return best;
  }
  std::vector<std::string> header_;
  std::vector<Line> rows_;
};

std::string ContactTable(const Experiment& e) {
  HtmlTable table({"method", "K", "B", "p", "force in contact, mN", "force overall, mN", "against noisy force, L2 in N",
                   "95 % covers K, %", "B, %", "p, %", "ms per pack", "draws"});
  for (const Row& row : e.rows) {
    const ContactScore& s = row.contact;
    const double none = std::nan("");
    const auto percent = [&](double v) { return row.has_intervals ? 100.0 * v : none; };
    table.Add(row.label + (row.online ? "" : " (sees all)"),
              {s.mae_active_contact[0], s.mae_active_contact[1], s.mae_active_contact[2], s.force_contact_mn,
               s.force_overall_mn, s.noisy_force_l2_n, percent(s.coverage[2][0]), percent(s.coverage[2][1]),
               percent(s.coverage[2][2]), s.median_ms, row.has_intervals ? s.mean_draws : none},
              row.online);
  }
  return table.ToString(6);
}

/// Whether the intervals of each method hold the truth, and what ARMCMC learns about drift.
std::string ContactDriftTable(const Experiment& e) {
  HtmlTable table({"method", "50 % covers K, %", "B, %", "p, %", "95 % covers K, %", "B, %", "p, %", "P(drift), %",
                   "K per s", "B per s", "p per s"});
  for (const Row& row : e.rows) {
    if (!row.has_intervals || row.key == "armcmc_ap") continue;  // its intervals are those of AR-MAP
    const ContactScore& s = row.contact;
    std::vector<double> values;
    for (const std::size_t level : {std::size_t{0}, std::size_t{2}})
      for (const double covers : s.coverage[level]) values.push_back(100.0 * covers);
    const bool learns = row.key.starts_with("armcmc");
    values.push_back(learns ? 100.0 * s.drift.share : std::nan(""));
    for (const double rate : s.drift.rate) values.push_back(learns ? rate : std::nan(""));
    table.Add(row.label, values, false);
  }
  return table.ToString(0);
}

std::string ActuatorDriftTable(const Experiment& e) {
  HtmlTable table({"method", "50 % covers g, %", "theta2, %", "95 % covers g, %", "theta2, %", "P(drift), %", "g per s",
                   "theta2 per s"});
  for (const Row& row : e.rows) {
    if (!row.has_intervals || row.key == "armcmc_ap") continue;
    const ActuatorScore& s = row.actuator;
    const bool learns = row.key.starts_with("armcmc");
    for (std::size_t m = 0; m < 2; ++m) {
      const double none = std::nan("");
      table.Add(row.label + (m == 0 ? ", u_c" : ", u_d"),
                {100.0 * s.coverage50[m][0], 100.0 * s.coverage50[m][1], 100.0 * s.coverage95[m][0],
                 100.0 * s.coverage95[m][1], learns ? 100.0 * s.drift[m].share : none,
                 learns ? s.drift[m].rate[0] : none, learns ? s.drift[m].rate[1] : none},
                false);
    }
  }
  return table.ToString(0);
}

std::string ActuatorTable(const Experiment& e) {
  HtmlTable table({"method", "g of u_c, relative", "g of u_d, relative", "theta1, L2", "theta2, L2 in 1e-6",
                   "angle from the inputs alone, L2 in rad", "angle restarted each pack, L2 in rad", "flow, relative",
                   "ms per pack"});
  for (const Row& row : e.rows) {
    const ActuatorScore& s = row.actuator;
    table.Add(row.label,
              {s.g_rel_error[0], s.g_rel_error[1], s.theta1_l2, 1e6 * s.theta2_l2, s.alpha_l2, s.alpha_restarted_l2,
               s.flow_rel_error, s.median_ms},
              row.online);
  }
  return table.ToString(7);
}

std::string PaperTable(const std::vector<std::string>& header, const std::vector<PaperRow>& rows) {
  HtmlTable table(header);
  for (const PaperRow& row : rows) table.Add(row.label, row.values, false);
  return table.ToString(0);
}

void PaperBlocks(const Experiment& e, plots::Page* page) {
  if (e.key == kContact.key()) {
    page->Html("<div class=\"grid\"><div class=\"card\"><h3>Printed in the paper</h3>" +
               PaperTable({"method", "K", "B", "p", "\"F_e, mN\""}, PublishedContact()) +
               "</div><div class=\"card\"><h3>From the authors' stored results</h3>" +
               PaperTable({"method", "K", "B", "p", "force in contact, mN", "overall, mN", "noisy, L2 in N"},
                          StoredContact()) +
               "</div></div>\n");
  } else if (e.key == kActuator.key()) {
    page->Html(
        "<div class=\"grid\"><div class=\"card\"><h3>Printed in the paper</h3>" +
        PaperTable({"method", "theta1, L2", "theta2, L2 in 1e-6", "angle, L2"}, PublishedActuator()) +
        "</div><div class=\"card\"><h3>From the authors' stored results</h3>" +
        PaperTable({"method", "theta1, L2", "theta2, L2 in 1e-6", "angle, L2", "flow, relative"}, StoredActuator()) +
        "</div></div>\n");
  }
}

std::string LikelihoodTable(const Result& result) {
  std::ostringstream out;
  out << "<div class=\"scroll\"><table><tr><th>noise</th><th>assumed</th><th></th><th class=\"num\">50 % covers</th>"
         "<th class=\"num\">90 %</th><th class=\"num\">95 %</th><th class=\"num\">force in contact, mN</th>"
         "<th class=\"num\">modifications per run</th></tr>\n";
  constexpr std::array<const char*, 3> kNames{"K", "B", "p"};
  for (const LikelihoodCell& cell : result.likelihoods) {
    const ContactScore& s = cell.row.contact;
    for (std::size_t d = 0; d < 3; ++d) {
      const bool first = d == 0;
      out << "<tr><td>" << (first ? cell.noise : "") << "</td><td>" << (first ? cell.assumed : "") << "</td><td>"
          << kNames[d] << "</td>";
      for (std::size_t l = 0; l < kLevels.size(); ++l)
        out << "<td class=\"num\">" << EscapeHtml(CoverageText(s.coverage[l][d], l, cell.row.coverage_error[l][d]))
            << "</td>";
      const double modifications = static_cast<double>(s.false_modifications) / cell.seeds;
      out << "<td class=\"num\">" << (first ? NumberText(s.force_contact_mn, 3) : "") << "</td><td class=\"num\">"
          << (first ? NumberText(modifications, 3) : "") << "</td></tr>\n";
    }
  }
  out << "</table></div>\n";
  return out.str();
}

void Lead(const Result& result, plots::Page* page) {
  const std::vector<std::string> lost = LostRows(result);
  std::ostringstream out;
  out << "<p class=\"lead\">Every method of the paper on the same packs, in one process, from the same prior. Contact "
         "data: "
      << EscapeHtml(result.contact_data) << "; actuator data: " << EscapeHtml(result.actuator_data)
      << ". An estimate is shown one period after its pack has ended, as in the paper. The best online value of a "
         "column is "
         "bold.</p>\n";
  if (!result.baselines) {
    out << "<p>ARMCMC alone: its baselines were left out.</p>\n";
  } else if (lost.empty()) {
    out << "<p>AR-MAP is ahead of every other online method on every row.</p>\n";
  } else {
    out << "<div class=\"note\"><p>Rows in which another method is ahead of AR-MAP:</p><ul class=\"plain\">";
    for (const std::string& row : lost) out << "<li>" << EscapeHtml(row) << "</li>";
    out << "</ul><p>" << EscapeHtml(LostRowsNote()) << "</p></div>\n";
  }
  page->Html(out.str());
}

}  // namespace

std::string ToHtml(const Result& result) {
  plots::Page page("ARMCMC: the paper's experiments, all methods");
  if (result.experiments.empty()) {
    page.Html("<h1>Coverage of the credible intervals</h1>\n");
  } else {
    page.Html("<h1>The paper's two experiments, every method, one run</h1>\n");
    Lead(result, &page);
  }
  for (const Experiment& e : result.experiments) {
    page.Html("<section class=\"card\"><h2>" + EscapeHtml(e.title) + "</h2>\n");
    PaperBlocks(e, &page);
    page.Html("<h3>Ours" + std::string(e.seeds > 1 ? ", mean over " + std::to_string(e.seeds) + " noise seeds" : "") +
              (kContact.Is(e.plant) ? ": mean absolute errors in contact while an estimate is shown" : "") + "</h3>\n");
    page.Html(kContact.Is(e.plant) ? ContactTable(e) : ActuatorTable(e));
    page.Html(kContact.Is(e.plant) ? ContactDriftTable(e) : ActuatorDriftTable(e));
    if (kContact.Is(e.plant)) page.Html("<p>" + EscapeHtml(CoverageSentence(e.Find("armcmc_map"))) + "</p>\n");
    if (e.key == kContact.key()) page.Html("<p class=\"soft\">" + EscapeHtml(ContactNote()) + "</p>\n");
    if (e.key == kActuator.key()) page.Html("<p class=\"soft\">" + EscapeHtml(ActuatorNote()) + "</p>\n");
    AddFigures(e, &page);
    page.Html("</section>\n");
  }
  if (!result.likelihoods.empty())
    page.Html(
        "<section class=\"card\"><h2>Right and wrong likelihoods</h2><p>Share of the packs, in percent, whose "
        "intervals "
        "contain the truth when the estimator assumes a noise law, right or wrong, with its standard error. The "
        "packs of one run share their data: the error is that of correct intervals, derived from how the posteriors "
        "contract, or the scatter between runs, whichever is larger. Deviations of more than two errors are "
        "marked.</p>" +
        LikelihoodTable(result) + "</section>\n");
  page.Html("<section class=\"card\"><h2>Number of draws</h2>\n");
  AddDrawNumbers(&page);
  page.Html("</section>\n");
  return page.ToString();
}

}  // namespace armcmc::tables
