#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "armcmc/rtcheck/findings.hpp"

namespace armcmc::rtcheck {
namespace {

using Json = nlohmann::ordered_json;

const char* Mark(Level level) {
  switch (level) {
    case Level::kOk: return "ok";
    case Level::kAdvice: return "advice";
    case Level::kUnfit: return "UNFIT";
  }
  return "";
}

/// Wake-ups by powers of two of a microsecond.
std::vector<std::pair<double, double>> Bins(const rt::LogHistogram& late) {
  std::vector<std::pair<double, double>> bins;
  const auto count = static_cast<double>(late.count());
  double before = 0.0;
  for (double edge_us = 1.0; edge_us < 2e7; edge_us *= 2.0) {
    double lo = 0.0, hi = 1.0;  // share of those below the edge
    for (int i = 0; i < 40; ++i) (late.Quantile(0.5 * (lo + hi)) <= edge_us * 1e3 ? lo : hi) = 0.5 * (lo + hi);
    const double n = std::round(lo * count) - before;
    before += n;
    if (n > 0.0) bins.emplace_back(edge_us, n);
  }
  return bins;
}

}  // namespace

bool IsFit(const std::vector<Finding>& findings) {
  return std::none_of(findings.begin(), findings.end(), [](const Finding& f) { return f.level == Level::kUnfit; });
}

std::string ReportText(const std::vector<Finding>& findings, const WakeUps* wake_ups, const Demand& demand) {
  std::string text;
  for (const Finding& finding : findings) {
    char head[64];
    std::snprintf(head, sizeof head, "%-8s %-16s ", Mark(finding.level), finding.name.c_str());
    text += head + finding.what + "\n";
    const std::string indent(26, ' ');
    if (!finding.cost.empty()) text += indent + "costs: " + finding.cost + "\n";
    if (!finding.remedy.empty()) text += indent + "fix:   " + finding.remedy + "\n";
  }
  if (wake_ups != nullptr && wake_ups->late_ns.count() > 0) {
    text += "\nlateness of the wake-ups (bars logarithmic)\n";
    for (const auto& [edge_us, n] : Bins(wake_ups->late_ns)) {
      char line[64];
      std::snprintf(line, sizeof line, "  up to %9.0f us %8.0f ", edge_us, n);
      text += line + std::string(static_cast<std::size_t>(1.0 + 6.0 * std::log10(n)), '#') + "\n";
    }
  }
  char verdict[128];
  std::snprintf(verdict, sizeof verdict, "\n%s for a period of %g ms and a deadline of %g ms\n",
                IsFit(findings) ? "fit" : "NOT FIT", demand.period_ms, demand.deadline_ms);
  return text + verdict;
}

std::string ReportJson(const std::vector<Finding>& findings, const WakeUps* wake_ups, const Demand& demand) {
  Json json = {{"schema", 1},
               {"fit", IsFit(findings)},
               {"period_ms", demand.period_ms},
               {"deadline_ms", demand.deadline_ms},
               {"cpu", demand.cpu},
               {"findings", Json::array()}};
  for (const Finding& f : findings) {
    json["findings"].push_back(
        {{"name", f.name}, {"level", Mark(f.level)}, {"what", f.what}, {"cost", f.cost}, {"remedy", f.remedy}});
  }
  if (wake_ups != nullptr) {
    const rt::LogHistogram& late = wake_ups->late_ns;
    Json bins = Json::array();
    for (const auto& [edge_us, n] : Bins(late)) bins.push_back({{"up_to_us", edge_us}, {"count", n}});
    json["wake_up_ms"] = {{"p50", late.Quantile(0.5) * 1e-6},
                          {"p99", late.Quantile(0.99) * 1e-6},
                          {"p999", late.Quantile(0.999) * 1e-6},
                          {"max", static_cast<double>(late.max()) * 1e-6},
                          {"count", late.count()},
                          {"fifo", wake_ups->fifo},
                          {"histogram", bins}};
  }
  return json.dump(2) + "\n";
}

}  // namespace armcmc::rtcheck
