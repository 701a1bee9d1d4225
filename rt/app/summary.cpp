#include "summary.hpp"

#include <sstream>

#include "armcmc/plant/program.hpp"
#include "armcmc/rt/clock.hpp"
#include "armcmc/support/text_table.hpp"

namespace armcmc::app {
namespace {

using support::Significant;
using support::TextTable;

std::string Ms(double ns) { return Significant(ns / static_cast<double>(rt::kNanosPerMilli), 4); }

void AddTimes(const char* name, const rt::LogHistogram& h, TextTable* table) {
  table->AddRow({name, Ms(h.Quantile(0.5)), Ms(h.Quantile(0.99)), Ms(h.Quantile(0.999)), Ms(h.max())});
}

std::string StageTimes(const rt::Pipeline& pipeline, const rt::Lane& lane) {
  TextTable table({"time, ms", "p50", "p99", "p99.9", "max"});
  const rt::DeadlineMonitor& monitor = lane.monitor();
  if (monitor.end_to_end().count() == 0) return {};
  AddTimes("collect", monitor.stage_times(rt::Stage::kCollect), &table);
  AddTimes("adjust", monitor.stage_times(rt::Stage::kAdjust), &table);
  AddTimes("execute", monitor.stage_times(rt::Stage::kExecute), &table);
  AddTimes("release to estimate", monitor.end_to_end(), &table);
  AddTimes("arrival to published", lane.latency().from_arrival(), &table);
  if (lane.latency().from_sample().count() > 0)  // not of a plant with another clock
    AddTimes("last sample to published", lane.latency().from_sample(), &table);
  rt::LogHistogram witness;
  for (const auto& w : pipeline.witnesses()) witness.Merge(w->delays());
  AddTimes("wake-up latency", witness, &table);
  return table.ToString();
}

std::string Parameters(const rt::Lane& lane, const Estimator& estimator) {
  TextTable table({"parameter", "estimate", "sd", "unit"});
  bool any = false;
  for (int m = 0; m < estimator.num_modes(); ++m) {
    const ModeEstimate& mode = lane.last_estimate().modes[static_cast<std::size_t>(m)];
    if (!mode.known) continue;
    for (int i = 0; i < estimator.num_reported(); ++i) {
      const MarginalSummary& marginal = mode.marginal[static_cast<std::size_t>(i)];
      const ReportedQuantity quantity = estimator.reported(i);
      std::string name(quantity.name);
      if (estimator.num_modes() > 1) name += " (" + std::string(estimator.mode_name(m)) + ")";
      table.AddRow({name, Significant(marginal.ar_map, 5), Significant(marginal.sd, 3), std::string(quantity.unit)});
      any = true;
    }
  }
  return any ? table.ToString() : "no parameter was estimated: no pack with information was received\n";
}

/// @param model  As the user may call it, or its plant file.
std::string Gap(const GapState& gap, const std::string& window, const std::string& model) {
  if (!gap.watched) return {};
  if (gap.num_blocks == 0) return "gap between model and plant: not judged, since too few packs were usable\n";
  std::ostringstream out;
  if (!gap.suspected) {
    out << "gap between model and plant: none suspected (log evidence " << Significant(gap.log_evidence, 3)
        << ", threshold " << Significant(gap.log_threshold, 3) << ")\n";
    return out.str();
  }
  out << "GAP SUSPECTED since pack " << gap.since_seq << ": the model is missing something, seen in "
      << gap.where.view() << " (log evidence " << Significant(gap.log_evidence, 3) << ", threshold "
      << Significant(gap.log_threshold, 3) << ")\n";
  if (!window.empty())
    out << "data: " << window << "; to find what is missing: armcmc-gap --model " << model << " --data " << window
        << " --out FOLDER\n";
  return out.str();
}

}  // namespace

std::string SummaryText(const rt::Pipeline& pipeline, const rt::Lane& lane, const Estimator& estimator,
                        const std::string& gap_window) {
  const rt::Counters& c = lane.counters();
  const rt::DeadlineMonitor& m = lane.monitor();
  std::ostringstream out;
  const auto missed = [&m](rt::MissCause cause) { return m.misses(cause); };
  out << "steps " << c.execute.steps.Get() << ", deadline " << Ms(static_cast<double>(pipeline.settings().deadline_ns))
      << " ms, missed: own " << missed(rt::MissCause::kOwn) << ", machine " << missed(rt::MissCause::kMachine)
      << ", late data " << missed(rt::MissCause::kLateData) << '\n';
  out << "packs " << c.collect.received.Get() << ", lost " << c.collect.lost.Get() << ", rejected " << c.Rejected()
      << ", duplicate " << c.collect.duplicate.Get() << ", reordered " << c.collect.reordered.Get() << ", dropped "
      << c.Dropped() << '\n';
  const rt::LogHistogram& draws = lane.execute().draws();
  if (draws.count() > 0) {
    out << "draws per posterior: median " << draws.Quantile(0.5) << ", minimum " << draws.min()
        << "; effective: median " << lane.execute().ess().Quantile(0.5) << '\n';
  }
  const EstimatorSettings& settings = estimator.settings();
  out << Gap(lane.last_estimate().gap, gap_window,
             settings.plant != nullptr ? settings.plant->plant().description().name : settings.model);
  const auto degraded = rt::DegradedNames(pipeline.degraded_flags());
  if (!degraded.empty()) {
    out << "degraded:";
    for (const std::string& name : degraded) out << ' ' << name;
    out << '\n';
  }
  out << '\n' << StageTimes(pipeline, lane) << (c.execute.steps.Get() > 0 ? "\n" : "") << Parameters(lane, estimator);
  return out.str();
}

}  // namespace armcmc::app
