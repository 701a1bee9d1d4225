#include "report.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "armcmc/rt/clock.hpp"

namespace armcmc::rt {
namespace {

using Json = nlohmann::ordered_json;

double Ms(double ns) { return ns / static_cast<double>(kNanosPerMilli); }

Json LatencyMs(const LogHistogram& h) {
  return {{"p50", Ms(h.Quantile(0.5))},
          {"p99", Ms(h.Quantile(0.99))},
          {"p999", Ms(h.Quantile(0.999))},
          {"max", Ms(h.max())},
          {"count", h.count()}};
}

Json Misses(const DeadlineMonitor& m) {
  return {{"own", m.misses(MissCause::kOwn)},
          {"machine", m.misses(MissCause::kMachine)},
          {"late_data", m.misses(MissCause::kLateData)}};
}

Json StageTimes(const DeadlineMonitor& m) {
  return {{"collect", LatencyMs(m.stage_times(Stage::kCollect))},
          {"adjust", LatencyMs(m.stage_times(Stage::kAdjust))},
          {"execute", LatencyMs(m.stage_times(Stage::kExecute))},
          {"end_to_end", LatencyMs(m.end_to_end())}};
}

/// Before each stage; in one step, these and `stage_ms` add up to the time from arrival to the end of execute.
Json WaitingTimes(const DeadlineMonitor& m) {
  return {{"collect", LatencyMs(m.waiting_times(Stage::kCollect))},
          {"adjust", LatencyMs(m.waiting_times(Stage::kAdjust))},
          {"execute", LatencyMs(m.waiting_times(Stage::kExecute))}};
}

/// From the data to their estimate on the bus; `end_to_end` of stage_ms is from the release to the end of execute.
Json LatencyToPublished(const PublicationLatency& latency) {
  return {{"from_arrival", LatencyMs(latency.from_arrival())}, {"from_last_sample", LatencyMs(latency.from_sample())}};
}

Json Allocations(const Counters& c, bool counted) {
  const auto of = [&c, counted](Stage stage) {
    return counted ? Json(c.heap_calls[IndexOf(stage)].Get()) : Json(nullptr);
  };
  return {{"collect", of(Stage::kCollect)}, {"adjust", of(Stage::kAdjust)}, {"execute", of(Stage::kExecute)}};
}

Json Packs(const Counters& c) {
  Json causes = Json::object();
  for (std::size_t i = 1; i < kNumRejectCauses; ++i) {
    const auto n = c.collect.rejected[i].Get();
    if (n > 0) causes[std::string(ToString(static_cast<RejectCause>(i)))] = n;
  }
  return {{"received", c.collect.received.Get()},
          {"lost", c.collect.lost.Get()},
          {"rejected", c.Rejected()},
          {"duplicate", c.collect.duplicate.Get()},
          {"reordered", c.collect.reordered.Get()},
          {"dropped", c.Dropped()},
          {"rejected_by_cause", causes}};
}

Json Witnesses(const Pipeline& p) {
  LogHistogram all;
  for (const auto& witness : p.witnesses()) all.Merge(witness->delays());
  Json json = LatencyMs(all);
  json["period"] = Ms(static_cast<double>(Witness::PeriodFor(p.settings().deadline_ns)));
  return json;
}

Json RtState(const Pipeline& p) {
  bool all_fifo = true;
  Json priorities = Json::object(), cpus = Json::object(), witness_cpus = Json::array();
  for (const ThreadPlacement& placement : p.placements()) {
    all_fifo = all_fifo && placement.fifo;
    priorities[placement.name] = placement.priority;
    const Json cpu = placement.cpu >= 0 ? Json(placement.cpu) : Json(nullptr);
    if (placement.name == "witness") {
      witness_cpus.push_back(cpu);
    } else {
      cpus[placement.name] = cpu;
    }
  }
  cpus["witness"] = witness_cpus;
  return {{"mode", p.settings().mode == RtMode::kEnforce ? "enforce" : "best_effort"},
          {"policy", all_fifo ? "SCHED_FIFO" : "SCHED_OTHER"},
          {"priorities", priorities},
          {"cpus", cpus},
          {"mlockall", p.memory_locked()},
          {"cpus_kept_awake", p.cpus_kept_awake()},
          {"degraded", DegradedNames(p.degraded_flags())}};
}

Json Finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json Parameters(const Lane& lane) {
  Json modes = Json::array();
  const Estimate& e = lane.last_estimate();
  const StepEngine& engine = lane.engine();
  for (int m = 0; m < engine.num_modes(); ++m) {
    const ModeEstimate& mode = e.modes[static_cast<std::size_t>(m)];
    Json parameters = Json::object();
    for (int i = 0; mode.known && i < engine.num_reported(); ++i) {
      const MarginalSummary& marginal = mode.marginal[static_cast<std::size_t>(i)];
      parameters[std::string(engine.reported(i).name)] = {{"ar_map", Finite(marginal.ar_map)},
                                                          {"ar_ap", Finite(marginal.ar_ap)},
                                                          {"sd", Finite(marginal.sd)},
                                                          {"unit", engine.reported(i).unit}};
    }
    modes.push_back({{"mode", m}, {"known", mode.known}, {"parameters", parameters}});
  }
  return modes;
}

Json Injected(const Injection* injection) {
  if (injection == nullptr) return nullptr;
  Json counts = Json::object();
  for (std::size_t i = 0; i < kNumInjectionKinds; ++i) {
    const auto kind = static_cast<InjectionKind>(i);
    if (injection->count(kind) > 0) counts[std::string(ToString(kind))] = injection->count(kind);
  }
  return counts;
}

Json Gap(const GapState& gap, const std::string& window) {
  return {{"watched", gap.watched},
          {"suspected", gap.suspected},
          {"where", gap.check >= 0 ? Json(gap.where.view()) : Json(nullptr)},
          {"log_evidence", gap.log_evidence},
          {"log_threshold", gap.log_threshold},
          {"share_of_excess_error", gap.share},
          {"since_pack", gap.since_seq > 0 ? Json(gap.since_seq) : Json(nullptr)},
          {"alarm_pack", gap.suspected ? Json(gap.alarm_seq) : Json(nullptr)},
          {"blocks", gap.num_blocks},
          {"window", window.empty() ? Json(nullptr) : Json(window)}};
}

Json SnapshotState(const std::optional<SnapshotCounts>& s) {
  if (!s) return nullptr;
  return {{"file", s->path},
          {"resumed_from_pack", s->resumed_from > 0 ? Json(s->resumed_from) : Json(nullptr)},
          {"written", s->written},
          {"failed", s->failed}};
}

}  // namespace

std::string ReportJson(const Pipeline& p, const Lane& lane, const std::string& gap_window,
                       const std::optional<SnapshotCounts>& snapshot) {
  const RtSettings& s = p.settings();
  const Counters& c = lane.counters();
  const DeadlineMonitor& m = lane.monitor();
  const LogHistogram& draws = lane.execute().draws();
  const LogHistogram& ess = lane.execute().ess();
  const Json report = {
      {"schema", 1},
      {"steps", c.execute.steps.Get()},
      {"plants_in_process", p.num_lanes()},
      {"period_ms", Ms(static_cast<double>(s.period_ns))},
      {"deadline_ms", Ms(static_cast<double>(s.deadline_ns))},
      {"adjust_budget_ms", Ms(static_cast<double>(s.adjust_budget_ns))},
      {"misses", Misses(m)},
      {"stage_ms", StageTimes(m)},
      {"waiting_ms", WaitingTimes(m)},
      {"published_ms", LatencyToPublished(lane.latency())},
      {"stage_overruns",
       {{"collect", m.stage_overruns(Stage::kCollect)},
        {"adjust", m.stage_overruns(Stage::kAdjust)},
        {"execute", m.stage_overruns(Stage::kExecute)}}},
      {"allocations", Allocations(c, p.heap_calls_counted())},
      {"packs", Packs(c)},
      {"plant", {{"silent_periods", c.collect.silent_periods.Get()}, {"restarts", c.collect.restarts.Get()}}},
      {"bus",
       {{"url", s.lcm_url},
        {"prefix", lane.prefix()},
        {"messages", c.publish.messages.Get()},
        {"publish_errors", c.publish.errors.Get() + c.execute.unpublished.Get()},
        {"foreign", c.collect.foreign.Get()},
        {"fragments", c.collect.fragments.Get()},
        {"malformed", c.collect.malformed.Get()}}},
      {"witness_ms", Witnesses(p)},
      {"rt", RtState(p)},
      {"draws",
       {{"median", draws.Quantile(0.5)},
        {"min", draws.min()},
        {"max", draws.max()},
        {"truncated_steps", c.adjust.truncated.Get()}}},
      {"ess", {{"median", ess.Quantile(0.5)}, {"min", ess.min()}}},
      {"hangs", p.watchdog().hangs()},
      {"injected", Injected(p.injection())},
      {"numeric_troubles", c.adjust.numeric.Get()},
      {"gap", Gap(lane.last_estimate().gap, gap_window)},
      {"snapshot", SnapshotState(snapshot)},
      {"parameters", Parameters(lane)}};
  return report.dump(2) + "\n";
}

void WriteReport(const Pipeline& pipeline, const Lane& lane, const std::string& path, const std::string& gap_window,
                 const std::optional<SnapshotCounts>& snapshot) {
  const std::string text = ReportJson(pipeline, lane, gap_window, snapshot);
  const std::string temporary = path + ".tmp";
  {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out << text;
    out.flush();
    if (!out) {
      std::remove(temporary.c_str());
      throw std::runtime_error("cannot write the report " + path);
    }
  }
  if (std::rename(temporary.c_str(), path.c_str()) != 0) {
    std::remove(temporary.c_str());
    throw std::runtime_error("cannot write the report " + path);
  }
}

}  // namespace armcmc::rt
