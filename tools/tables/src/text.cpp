#include <cmath>
#include <sstream>

#include "armcmc/support/text_table.hpp"
#include "armcmc/tables/plants/registry.hpp"
#include "armcmc/tables/report.hpp"

namespace armcmc::tables {
namespace {

using support::Significant;
using support::TextTable;

void Put(std::ostringstream* out, const std::string& title, const TextTable& table) {
  *out << title << '\n' << table.ToString() << '\n';
}

std::string Percent(double share) { return Significant(100.0 * share, 3); }

/// Of every method that has intervals: whether they hold the truth; of ARMCMC: what it learns about drift.
void ContactDriftTable(const Experiment& e, std::ostringstream* out) {
  TextTable table({"intervals and drift", "50 % covers K", "B", "p", "95 % covers K", "B", "p", "drifts, %",
                   "rate of K per s", "B", "p"});
  for (const Row& row : e.rows) {
    if (!row.has_intervals || row.key == "armcmc_ap") continue;  // its intervals are those of AR-MAP
    const ContactScore& s = row.contact;
    std::vector<std::string> cells = {row.label};
    for (const std::size_t level : {std::size_t{0}, std::size_t{2}})
      for (const double covers : s.coverage[level]) cells.push_back(Percent(covers));
    const bool learns = row.key.starts_with("armcmc");
    cells.push_back(learns ? Percent(s.drift.share) : "-");
    for (const double rate : s.drift.rate) cells.push_back(learns ? Significant(rate, 3) : "-");
    table.AddRow(cells);
  }
  Put(out, e.title + ": coverage of the intervals over the packs in contact, %; estimated drift, mean over these packs",
      table);
}

void ActuatorDriftTable(const Experiment& e, std::ostringstream* out) {
  TextTable table({"intervals and drift", "valve", "50 % covers g", "theta2", "95 % covers g", "theta2", "drifts, %",
                   "rate of g per s", "theta2"});
  for (const Row& row : e.rows) {
    if (!row.has_intervals || row.key == "armcmc_ap") continue;
    const ActuatorScore& s = row.actuator;
    const bool learns = row.key.starts_with("armcmc");
    for (std::size_t m = 0; m < 2; ++m)
      table.AddRow({m == 0 ? row.label : "", m == 0 ? "u_c" : "u_d", Percent(s.coverage50[m][0]),
                    Percent(s.coverage50[m][1]), Percent(s.coverage95[m][0]), Percent(s.coverage95[m][1]),
                    learns ? Percent(s.drift[m].share) : "-", learns ? Significant(s.drift[m].rate[0], 3) : "-",
                    learns ? Significant(s.drift[m].rate[1], 3) : "-"});
  }
  Put(out, e.title + ": coverage of the intervals over the packs, %; estimated drift, mean over these packs", table);
}

void ContactTable(const Experiment& e, std::ostringstream* out) {
  TextTable table({"ours", "K", "B", "p", "force mN, contact", "overall", "noisy L2 N", "95 % covers K", "B", "p",
                   "ms per pack", "draws"});
  for (const Row& row : e.rows) {
    const ContactScore& s = row.contact;
    const auto percent = [&](double v) { return row.has_intervals ? Significant(100.0 * v, 3) : std::string("-"); };
    table.AddRow({row.label, Significant(s.mae_active_contact[0], 3), Significant(s.mae_active_contact[1], 3),
                  Significant(s.mae_active_contact[2], 3), Significant(s.force_contact_mn, 4),
                  Significant(s.force_overall_mn, 4), Significant(s.noisy_force_l2_n, 5), percent(s.coverage[2][0]),
                  percent(s.coverage[2][1]), percent(s.coverage[2][2]), Significant(s.median_ms, 3),
                  row.has_intervals ? Significant(s.mean_draws, 5) : "-"});
  }
  Put(out, e.title + ": mean absolute errors in contact while an estimate is shown", table);
  ContactDriftTable(e, out);
  *out << CoverageSentence(e.Find("armcmc_map")) << "\n\n";
}

void ActuatorTable(const Experiment& e, std::ostringstream* out) {
  TextTable table({"ours", "g u_c, rel", "g u_d, rel", "theta1 L2", "theta2 L2 1e-6", "angle L2, inputs alone",
                   "angle L2, restarted", "flow, rel", "ms per pack"});
  for (const Row& row : e.rows) {
    const ActuatorScore& s = row.actuator;
    table.AddRow({row.label, Significant(s.g_rel_error[0], 3), Significant(s.g_rel_error[1], 3),
                  Significant(s.theta1_l2, 3), Significant(1e6 * s.theta2_l2, 3), Significant(s.alpha_l2, 4),
                  Significant(s.alpha_restarted_l2, 4), Significant(s.flow_rel_error, 3), Significant(s.median_ms, 3)});
  }
  Put(out, e.title, table);
  ActuatorDriftTable(e, out);
}

void PaperTable(const std::string& title, const std::vector<std::string>& header, const std::vector<PaperRow>& rows,
                std::ostringstream* out) {
  TextTable table(header);
  for (const PaperRow& row : rows) {
    std::vector<std::string> cells = {row.label};
    for (const double v : row.values) cells.push_back(Significant(v, 5));
    table.AddRow(cells);
  }
  Put(out, title, table);
}

void LikelihoodTable(const Result& result, std::ostringstream* out) {
  TextTable table(
      {"noise", "assumed", "parameter", "50 % covers", "90 %", "95 %", "force mN", "modifications per run"});
  constexpr std::array<const char*, 3> kNames{"K", "B", "p"};
  for (const LikelihoodCell& cell : result.likelihoods) {
    const ContactScore& s = cell.row.contact;
    for (std::size_t d = 0; d < 3; ++d) {
      std::vector<std::string> cells = {d == 0 ? cell.noise : "", d == 0 ? cell.assumed : "", kNames[d]};
      for (std::size_t l = 0; l < kLevels.size(); ++l)
        cells.push_back(CoverageText(s.coverage[l][d], l, cell.row.coverage_error[l][d]));
      if (d == 0) cells.push_back(Significant(s.force_contact_mn, 4));
      if (d == 0) cells.push_back(Significant(static_cast<double>(s.false_modifications) / cell.seeds, 3));
      table.AddRow(cells);
    }
  }
  Put(out,
      "Each noise law under each assumed likelihood: coverage in percent with its standard error; deviations of "
      "more than two are marked",
      table);
}

}  // namespace

std::string ToText(const Result& result) {
  std::ostringstream out;
  for (const Experiment& e : result.experiments) {
    if (e.key == kContact.key()) {
      PaperTable(std::string(kContact.title) + ", printed in the paper", {"printed", "K", "B", "p", "\"F_e mN\""},
                 PublishedContact(), &out);
      PaperTable(std::string(kContact.title) + ", from the authors' stored results",
                 {"stored", "K", "B", "p", "force mN, contact", "overall", "noisy L2 N"}, StoredContact(), &out);
    } else if (e.key == kActuator.key()) {
      PaperTable(std::string(kActuator.title) + ", printed in the paper",
                 {"printed", "theta1 L2", "theta2 L2 1e-6", "angle L2"}, PublishedActuator(), &out);
      PaperTable(std::string(kActuator.title) + ", from the authors' stored results",
                 {"stored", "theta1 L2", "theta2 L2 1e-6", "angle L2", "flow, rel"}, StoredActuator(), &out);
    }
    if (kContact.Is(e.plant))
      ContactTable(e, &out);
    else
      ActuatorTable(e, &out);
    if (e.key == kContact.key()) out << ContactNote() << "\n\n";
    if (e.key == kActuator.key()) out << ActuatorNote() << "\n\n";
  }
  if (!result.likelihoods.empty()) LikelihoodTable(result, &out);
  if (result.experiments.empty() || !result.baselines) return out.str();
  const std::vector<std::string> lost = LostRows(result);
  out << (lost.empty() ? "AR-MAP is ahead of every other online method on every row.\n"
                       : "Rows in which another method is ahead of AR-MAP:\n");
  for (const std::string& row : lost) out << "  " << row << '\n';
  if (!lost.empty()) out << LostRowsNote() << '\n';
  return out.str();
}

std::string CoverageSentence(const Row& row) {
  constexpr std::array<const char*, 3> kNames{"K", "B", "p"};
  std::string off;
  double largest = 0.0;
  for (std::size_t l = 0; l < kLevels.size(); ++l)
    for (std::size_t d = 0; d < 3; ++d) {
      const double coverage = row.contact.coverage[l][d], error = row.coverage_error[l][d];
      largest = std::fmax(largest, error);
      if (JudgeCoverage(coverage, l, error) == Calibration::kAsStated) continue;
      off += (off.empty() ? "" : "; ") + Significant(100.0 * kLevels[l], 3) + " % of " + kNames[d] + " " +
             CoverageText(coverage, l, error);
    }
  return off.empty()
             ? "The 50, 90 and 95 % intervals of AR-MAP cover as stated, within two standard errors (of up to " +
                   Significant(100.0 * largest, 2) + " %)."
             : "Intervals of AR-MAP that are off by more than two standard errors: " + off + ".";
}

std::vector<std::string> LostRows(const Result& result) {
  std::vector<std::string> lost;
  for (const Experiment& e : result.experiments) {
    const bool contact = kContact.Is(e.plant);
    const auto values = [contact](const Row& row) {
      const ContactScore& c = row.contact;
      const ActuatorScore& a = row.actuator;
      using Named = std::vector<std::pair<std::string, double>>;
      if (contact)
        return Named{{"K", c.mae_active_contact[0]},
                     {"B", c.mae_active_contact[1]},
                     {"p", c.mae_active_contact[2]},
                     {"force in contact", c.force_contact_mn},
                     {"force overall", c.force_overall_mn}};
      return Named{{"g of u_c", a.g_rel_error[0]}, {"g of u_d", a.g_rel_error[1]}, {"theta1", a.theta1_l2},
                   {"theta2", a.theta2_l2},        {"angle", a.alpha_l2},          {"flow", a.flow_rel_error}};
    };
    const auto ours = values(e.Find("armcmc_map"));
    for (const Row& row : e.rows) {
      if (!row.online || row.key.starts_with("armcmc")) continue;
      const auto theirs = values(row);
      for (std::size_t i = 0; i < ours.size(); ++i)
        if (!(ours[i].second < theirs[i].second))
          lost.push_back(e.key + ", " + ours[i].first + ": " + row.label + " " + Significant(theirs[i].second, 4) +
                         ", AR-MAP " + Significant(ours[i].second, 4));
    }
  }
  return lost;
}

}  // namespace armcmc::tables
