#include <sstream>

#include "armcmc/gap/result_json.hpp"
#include "armcmc/gap_bench/report.hpp"
#include "armcmc/gap_bench/score.hpp"
#include "armcmc/gap_bench/summary.hpp"
#include "armcmc/support/text_table.hpp"

namespace armcmc::gap_bench {
namespace {

using support::Significant;
using support::TextTable;

std::string Sets(const gap::Result& result) {
  std::string text;
  for (const Names& set : SetsOf(result)) {
    text += text.empty() ? "" : " | ";
    for (std::size_t i = 0; i < set.size(); ++i) text += (i > 0 ? "+" : "") + set[i];
  }
  return text;
}

std::string Truths(const Outcome& o) {
  std::string text;
  for (const TrueEffect& effect : o.truth.effects)
    text += (text.empty() ? "" : ",") + effect.name + ":" + effect.variant;
  return text.empty() ? o.what.effect : text;
}

std::string CountTable(const std::vector<Outcome>& outcomes) {
  TextTable table({"stratum", "n", "right", "tie", "family", "partial", "unnamed", "none", "wrong", "failed",
                   "not shown", "not made"});
  for (const Row& row : Rows(outcomes)) {
    std::vector<std::string> cells = {row.stratum + ", " + row.group, std::to_string(row.counted())};
    for (const Grade grade : {Grade::kRight, Grade::kTie, Grade::kFamily, Grade::kPartial, Grade::kUnnamed,
                              Grade::kNone, Grade::kWrong, Grade::kFailed, Grade::kNotShown, Grade::kNotMade})
      cells.push_back(std::to_string(row.of(grade)));
    table.AddRow(std::move(cells));
  }
  return table.ToString();
}

std::string GateTable(const std::vector<Outcome>& outcomes) {
  TextTable table({"gate", "value", "limit", "n", ""});
  for (const Gate& gate : Gates(outcomes))
    table.AddRow({gate.stratum + ": " + gate.metric, Significant(gate.value, 3),
                  (gate.at_least ? ">= " : "<= ") + Significant(gate.limit, 3), std::to_string(gate.n),
                  gate.passed() ? "passed" : "FAILED"});
  return table.ToString();
}

std::string CalibrationTable(const std::vector<Outcome>& outcomes) {
  TextTable table({"printed P", "n", "mean", "came true"});
  for (const Bin& bin : Calibrate(outcomes).bins)
    if (bin.n > 0)
      table.AddRow({Significant(bin.low, 2) + " to " + Significant(bin.high, 2), std::to_string(bin.n),
                    Significant(bin.printed, 3), Significant(bin.right, 3)});
  return table.ToString();
}

/// With an empty line behind it; nothing if no recording belongs to it.
std::string ConfusionTable(const std::vector<Outcome>& outcomes, bool imperfect) {
  const Confusion confusion = Confuse(outcomes, imperfect);
  TextTable table({imperfect ? "truth, where the plant is not the catalogue" : "truth", "n", "answers"});
  bool any = false;
  for (std::size_t r = 0; r < confusion.names.size(); ++r) {
    int n = 0;
    std::string answers;
    for (std::size_t c = 0; c < confusion.answers.size(); ++c) {
      const int count = confusion.count[r][c];
      n += count;
      if (count > 0) answers += (answers.empty() ? "" : ", ") + std::to_string(count) + " " + confusion.answers[c];
    }
    if (n > 0) table.AddRow({confusion.names[r], std::to_string(n), answers});
    any = any || n > 0;
  }
  return any ? table.ToString() + '\n' : "";
}

}  // namespace

std::string Line(const Outcome& o) {
  std::ostringstream line;
  line << GradeName(o.grade) << ": " << o.what.stratum << ", " << o.what.group << ", " << Truths(o);
  if (!o.what.gate.empty()) line << ' ' << o.what.gate;
  line << ", seed " << o.what.seed;
  if (o.grade == Grade::kNotMade) return line.str();
  if (o.grade == Grade::kFailed) return line.str() + ": " + o.answer.error;
  const gap::Result& result = o.answer.result;
  line << " -> " << gap::Name(result.verdict);
  if (!SetsOf(result).empty()) line << ' ' << Sets(result) << ", closed " << Significant(result.gap.closed_fraction, 3);
  line << ", P " << Significant(o.label_probability, 3) << " of " << o.label;
  if (o.first_rung) line << ", " << Significant(*o.first_rung, 3) << " of what the truth would close";
  if (o.onset_error_s) line << ", onset off by " << Significant(*o.onset_error_s, 2) << " s";
  if (o.diagnosed_strength) line << ", at most R " << Significant(*o.diagnosed_strength, 2) << " in what was diagnosed";
  line << ", " << Significant(o.answer.cpu_s, 2) << " s";
  return line.str();
}

std::string Tables(const std::vector<Outcome>& outcomes) {
  return CountTable(outcomes) + '\n' + ConfusionTable(outcomes, false) + ConfusionTable(outcomes, true) +
         CalibrationTable(outcomes) + '\n' + GateTable(outcomes);
}

}  // namespace armcmc::gap_bench
