#include "armcmc/stress/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "armcmc/plots/html.hpp"
#include "armcmc/plots/page.hpp"
#include "armcmc/stress/verdict.hpp"
#include "armcmc/support/text_table.hpp"

namespace armcmc::stress {
namespace {

using Json = nlohmann::ordered_json;
using support::Significant;

// Shares of the steps that are slower: what a complementary distribution shows.
constexpr std::array kShares = {1.0,  0.9,  0.7,  0.5,  0.3,  0.2,  0.1,  0.05, 0.03, 0.02, 0.01, 5e-3,
                                3e-3, 2e-3, 1e-3, 5e-4, 3e-4, 2e-4, 1e-4, 5e-5, 3e-5, 2e-5, 1e-5};

double Ms(double ns) { return ns * 1e-6; }

std::string Number(std::int64_t n) { return std::to_string(n); }

std::string FaultTable(const std::vector<PhaseResult>& phases) {
  support::TextTable table({"fault", "injected", "detected", "swallowed", "recovered", "stalled", "detected by"});
  for (const FaultTally& fault : AllFaults(phases)) {
    const std::string steps = fault.recovered_steps >= FaultJudge::kNever ? "no" : Number(fault.recovered_steps);
    table.AddRow({fault.fault->name, Number(fault.injected), Number(fault.detected), Number(fault.swallowed), steps,
                  Number(fault.stalled_steps), fault.fault->detected_by});
  }
  return table.ToString();
}

std::string PhaseTable(const std::vector<PhaseResult>& phases) {
  support::TextTable table({"load", "s", "steps", "own", "of faults", "outside", "machine", "late data", "p50 ms",
                            "p99 ms", "p99.9 ms", "max ms", "witness max", "RSS MB"});
  for (const PhaseResult& phase : phases) {
    if (!phase.trouble.empty()) {
      table.AddRow({phase.load, phase.trouble});
      continue;
    }
    const Json& report = phase.report;
    const Json& misses = report["misses"];
    const Json& times = report["stage_ms"]["end_to_end"];
    const auto ms = [](const Json& value) { return Significant(value.get<double>(), 4); };
    table.AddRow({phase.load, Significant(phase.seconds, 3), report["steps"].dump(), misses["own"].dump(),
                  Number(misses["own"].get<std::int64_t>() - phase.own_misses_outside),
                  Number(phase.own_misses_outside), misses["machine"].dump(), misses["late_data"].dump(),
                  ms(times["p50"]), ms(times["p99"]), ms(times["p999"]), ms(times["max"]),
                  ms(report["witness_ms"]["max"]),
                  Significant(static_cast<double>(phase.rss_start_kb) / 1024.0, 3) + " to " +
                      Significant(static_cast<double>(phase.rss_end_kb) / 1024.0, 3)});
  }
  return table.ToString();
}

rt::LogHistogram AllSteps(const std::vector<PhaseResult>& phases) {
  rt::LogHistogram all;
  for (const PhaseResult& phase : phases) all.Merge(phase.end_to_end);
  return all;
}

/// Share of steps in bins of a third of a decade, as bars on a logarithmic scale.
std::string HistogramText(const rt::LogHistogram& steps) {
  if (steps.count() == 0) return "";
  std::string text = "release to estimate, all phases (steps per third of a decade, bars logarithmic)\n";
  const double count = static_cast<double>(steps.count());
  for (double edge = 0.01; edge < 20'000.0; edge *= std::cbrt(10.0)) {
    const double to = edge * std::cbrt(10.0);
    const auto below = [&steps](double ms) {
      double lo = 0.0, hi = 1.0;
      for (int i = 0; i < 40; ++i) (steps.Quantile(0.5 * (lo + hi)) <= ms * 1e6 ? lo : hi) = 0.5 * (lo + hi);
      return lo;
    };
    const double n = std::round(count * (below(to) - below(edge)));
    if (n < 1.0) continue;
    char line[80];
    std::snprintf(line, sizeof line, "%9.3g .. %-8.3g ms %9.0f ", edge, to, n);
    text += line + std::string(static_cast<std::size_t>(4.0 * std::log10(n) + 1.0), '#') + "\n";
  }
  return text;
}

Json FaultJson(const FaultTally& fault) {
  return {{"name", fault.fault->name},      {"injected", fault.injected},
          {"detected", fault.detected},     {"recovered_steps", fault.recovered_steps},
          {"swallowed", fault.swallowed},   {"stalled_steps", fault.stalled_steps},
          {"own_misses", fault.own_misses}, {"detected_by", fault.fault->detected_by},
          {"flags", FlagNames(fault.flags)}};
}

Json FaultsJson(const std::vector<FaultTally>& faults) {
  Json json = Json::array();
  for (const FaultTally& fault : faults) json.push_back(FaultJson(fault));
  return json;
}

}  // namespace

std::string ReportJson(const StressOptions& options, const std::vector<PhaseResult>& phases) {
  const Verdict verdict = Judge(phases);
  Json json = {{"schema", 1},
               {"verdict", verdict.Text()},
               {"reasons", verdict.reasons},
               {"minutes", options.minutes},
               {"period_ms", options.period_ms},
               {"deadline_ms", options.DeadlineMs()},
               {"draws", options.draws},
               {"faults", FaultsJson(AllFaults(phases))},
               {"phases", Json::array()}};
  for (const PhaseResult& phase : phases) {
    Json one = {{"load", phase.load},
                {"notes", phase.notes},
                {"seconds", phase.seconds},
                {"trouble", phase.trouble},
                {"own_misses_outside_faults", phase.own_misses_outside},
                {"rss_kb", {{"start", phase.rss_start_kb}, {"end", phase.rss_end_kb}}},
                {"faults", FaultsJson(phase.faults)}};
    if (phase.report.is_object()) one.update(phase.report);
    json["phases"].push_back(one);
  }
  return json.dump(2) + "\n";
}

std::string PhaseLine(const PhaseResult& phase) {
  if (!phase.trouble.empty()) return "load " + phase.load + ": " + phase.trouble;
  return "load " + phase.load + ": " + phase.report["steps"].dump() +
         " steps, own misses outside of faults: " + Number(phase.own_misses_outside);
}

std::string ReportText(const StressOptions& /*options*/, const std::vector<PhaseResult>& phases) {
  std::string text = PhaseTable(phases) + "\n";
  for (const PhaseResult& phase : phases) {
    for (const std::string& note : phase.notes)
      if (note.find("skipped") != std::string::npos) text += "load " + phase.load + ": " + note + "\n";
  }
  text += "\n" + FaultTable(phases) + "\n" + HistogramText(AllSteps(phases));
  return text + "\nverdict: " + Judge(phases).Text() + "\n";
}

std::string ReportHtml(const StressOptions& options, const std::vector<PhaseResult>& phases) {
  plots::Page page("Stress: " + Judge(phases).Text());
  page.Html("<p>" +
            plots::EscapeHtml("Period " + Significant(options.period_ms, 4) + " ms, deadline " +
                              Significant(options.DeadlineMs(), 4) + " ms, " + Significant(options.minutes, 4) +
                              " minutes.") +
            "</p>");
  plots::XyChart chart;
  chart.x_title = "release to estimate, ms";
  chart.y_title = "share of the steps that took longer";
  chart.log_x = chart.log_y = true;
  for (const PhaseResult& phase : phases) {
    plots::Series series;
    series.label = phase.load;
    for (const double share : kShares) {
      if (share * static_cast<double>(phase.end_to_end.count()) < 1.0) break;
      series.x.push_back(Ms(phase.end_to_end.Quantile(1.0 - share)));
      series.y.push_back(share);
    }
    chart.series.push_back(std::move(series));
  }
  page.Chart(chart,
             "One curve per load, including the steps with injected faults. Further left is better; every estimate "
             "is due by the deadline.");
  page.Html("<pre>" + plots::EscapeHtml(ReportText(options, phases)) + "</pre>");
  return page.ToString();
}

}  // namespace armcmc::stress
