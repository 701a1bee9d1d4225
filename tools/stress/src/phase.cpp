#include "armcmc/stress/phase.hpp"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <utility>

#include "armcmc/rt/clock.hpp"
#include "armcmc/stress/child.hpp"
#include "armcmc/stress/files.hpp"
#include "armcmc/stress/flight_recorder.hpp"
#include "armcmc/stress/load.hpp"
#include "armcmc/stress/plant_runs.hpp"

namespace armcmc::stress {
namespace {

double SecondsSince(Nanos start_ns) {
  return static_cast<double>(rt::MonotonicNow() - start_ns) / static_cast<double>(rt::kNanosPerSecond);
}

std::string LastLine(const std::string& text) {
  const auto end = text.find_last_not_of('\n');
  if (end == std::string::npos) return "";
  const auto begin = text.find_last_of('\n', end);
  return text.substr(begin + 1, end - begin);
}

/// What the ends of a phase take: start of the estimator, two short runs of the plant, its report.
double EndsSeconds(const StressOptions& options) { return 2.5 + 40.0 * options.period_ms * 1e-3; }

/// What somebody who reads "not detected" or "own miss" wants to see next.
void RecordTrouble(const FaultOutcome& outcome, FlightRecorder* recorder) {
  const std::string name = outcome.fault->name;
  const auto statuses = static_cast<std::size_t>(outcome.statuses) + 3;
  if (outcome.injected && !outcome.detected) recorder->Write(name + " was not detected", statuses);
  if (outcome.injected && outcome.recovered_steps > kMostRecoverySteps) {
    recorder->Write(name + " did not recover: " + outcome.hindrance, statuses);
  }
}

void CountOutcomes(const std::vector<FaultOutcome>& outcomes, FlightRecorder* recorder,
                   std::vector<FaultTally>* tallies) {
  for (const FaultOutcome& outcome : outcomes) {
    RecordTrouble(outcome, recorder);
    auto found =
        std::find_if(tallies->begin(), tallies->end(), [&](const auto& t) { return t.fault == outcome.fault; });
    if (found == tallies->end()) found = tallies->emplace(tallies->end());
    found->fault = outcome.fault;
    found->Add(outcome);
  }
}

nlohmann::ordered_json ReadReport(const std::filesystem::path& path) {
  std::ifstream file(path);
  return nlohmann::ordered_json::parse(file, nullptr, false);
}

std::int64_t OwnMissesOutside(const PhaseResult& result) {
  std::int64_t own = result.report["misses"].value("own", std::int64_t{0});
  for (const FaultTally& tally : result.faults)
    if (tally.fault->misses) own -= tally.own_misses;
  return std::max<std::int64_t>(own, 0);
}

}  // namespace

void FaultTally::Add(const FaultOutcome& outcome) {
  own_misses += outcome.own_misses;
  if (!outcome.injected) {
    ++swallowed;
    return;
  }
  ++injected;
  detected += outcome.detected ? 1 : 0;
  if (outcome.recovered_steps > recovered_steps) hindrance = outcome.hindrance;
  recovered_steps = std::max(recovered_steps, outcome.recovered_steps);
  stalled_steps += outcome.stalled_steps;
  flags |= outcome.flags;
}

PhaseResult RunPhase(const StressOptions& options, const std::string& load_name, double seconds, std::size_t first,
                     const std::function<void(double)>& progress) {
  const Nanos start_ns = rt::MonotonicNow();
  PhaseResult result;
  result.load = load_name;
  const double run_seconds = seconds - EndsSeconds(options);
  const auto packs = static_cast<std::int64_t>(run_seconds * 1e3 / options.period_ms);
  const FaultLayout layout = LayOut(options.faults, first, options.period_ms, packs);
  result.slots_per_run = layout.slots.size();
  const auto scenario = options.work / "scenario.toml", config = options.work / "estimator.toml";
  const auto report = options.work / "estimator.json";
  WriteText(scenario, ScenarioText(options));
  WriteText(config, EstimatorConfigText(options, layout.estimator_plan));
  std::filesystem::remove(report);

  BusWatch bus(options.lcm_url, options.prefix);
  FlightRecorder recorder(options.work / ("trouble_" + load_name + ".txt"));
  bus.SetRecorder(&recorder);
  FaultJudge judge(static_cast<std::int64_t>(options.period_ms * 1e6));
  judge.BeginRun({});
  Child estimator({(options.programs / "armcmc-estimator").string(), "--config", config.string(), "--lcm-url",
                   options.lcm_url, "--prefix", options.prefix, "--report", report.string()},
                  options.work / "estimator.log");
  for (const Nanos end_ns = start_ns + 20 * rt::kNanosPerSecond; bus.statuses() == 0 && estimator.running();) {
    bus.Poll(20, &judge);
    if (rt::MonotonicNow() > end_ns) break;
  }
  if (bus.statuses() == 0) {
    estimator.Wait(1000);
    result.trouble = "the estimator did not start: " + LastLine(estimator.output());
    return result;
  }
  bus.BeginPhase();
  const Load load(load_name, options.lcm_url, options.work);
  result.notes = load.notes();
  std::int64_t own_misses = 0;
  const auto tick = [&] {
    const std::int64_t own_before = std::exchange(own_misses, judge.newest_status().missed_own);
    const bool of_a_fault = judge.current() != nullptr && judge.current()->fault->misses;
    if (own_misses > own_before && !of_a_fault) recorder.Write("an own miss outside of faults", 20);
    estimator.TrimLog();
    load.TrimFiles();
    if (result.rss_start_kb == 0 && SecondsSince(start_ns) > 1.5) result.rss_start_kb = estimator.rss_kb();
    progress(std::min(1.0, SecondsSince(start_ns) / seconds));
    CountOutcomes(judge.TakeOutcomes(), &recorder, &result.faults);
  };
  PlantRuns runs({&options, options.lcm_url, scenario, &bus, &judge, &estimator, tick}, layout);
  const double one_run = static_cast<double>(layout.last_pack) * options.period_ms * 1e-3;
  if (options.faults.empty()) {
    // The plant's scenario ends after an hour.
    double left = seconds;
    while (!runs.estimator_died() && left > 1.0) {
      runs.RunQuietly(1e3 * std::min(left, 3500.0));
      left = seconds - SecondsSince(start_ns) - 1.0;
    }
  } else {
    do {
      runs.RunWithFaults();
      runs.RunShortly();
    } while (!runs.estimator_died() && SecondsSince(start_ns) + one_run + EndsSeconds(options) < seconds);
    runs.RunShortly();
  }
  tick();
  result.rss_end_kb = estimator.rss_kb();
  estimator.Signal(SIGINT);
  estimator.Wait(10'000);
  result.end_to_end = bus.end_to_end();
  result.report = ReadReport(report);
  result.seconds = SecondsSince(start_ns);
  if (runs.estimator_died() || estimator.exit_code() != 0 || !result.report.is_object()) {
    result.trouble =
        "the estimator ended with " + std::to_string(estimator.exit_code()) + ": " + LastLine(estimator.output());
    return result;
  }
  result.own_misses_outside = OwnMissesOutside(result);
  return result;
}

}  // namespace armcmc::stress
