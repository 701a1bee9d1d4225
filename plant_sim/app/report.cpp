#include "report.hpp"

#include <armcmc/support/text_table.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace armcmc::plant_sim {
namespace {

using nlohmann::ordered_json;
using support::Significant;
using support::TextTable;

constexpr Convention kConventions[] = {Convention::kOnePackLater, Convention::kFromArrival};

const char* Describe(Convention convention) {
  return convention == Convention::kOnePackLater ? "shown one pack later, as the paper does"
                                                 : "shown from its arrival on";
}

struct DegradedFlag {
  std::int32_t bit;
  const char* text;
};
constexpr DegradedFlag kDegraded[] = {{estimator_status_t::DEGRADED_NO_FIFO, "no real-time scheduling"},
                                      {estimator_status_t::DEGRADED_NO_AFFINITY, "no processor of its own"},
                                      {estimator_status_t::DEGRADED_NO_MLOCK, "memory not locked"},
                                      {estimator_status_t::DEGRADED_SHARED_CPU, "stages share one processor"},
                                      {estimator_status_t::DEGRADED_NO_WITNESS, "no witness thread"},
                                      {estimator_status_t::DEGRADED_CPUS_SLEEP, "processors sleep when idle"},
                                      {estimator_status_t::DEGRADED_INJECTED, "injected faults"}};

std::vector<std::string> DegradedTexts(std::int32_t flags) {
  std::vector<std::string> texts;
  for (const DegradedFlag& flag : kDegraded)
    if ((flags & flag.bit) != 0) texts.emplace_back(flag.text);
  return texts;
}

/// JSON has no NaN: a number that does not exist is null.
ordered_json Number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); }

/// Keys carry the mode's name ("mae_contact"), and hold one number per parameter.
ordered_json ScoreJson(const PlantFamily& family, const Scorer& scorer, Convention convention) {
  const Score score = scorer.Result(convention);
  ordered_json json;
  for (std::size_t m = 0; m < family.modes.size(); ++m)
    for (std::size_t i = 0; i < family.truth_names.size(); ++i) {
      const ParameterScore& parameter = score.modes[m][i];
      const std::string& name = family.truth_names[i];
      json["mae_" + family.modes[m]][name] = Number(parameter.mae);
      json["mae_active_" + family.modes[m]][name] = Number(parameter.mae_active);
      json[name + "_rel_error"][family.modes[m]] = Number(parameter.rel_active);
      json["final"][family.modes[m]][name] = Number(parameter.final_value);
    }
  const TargetSpec& target = family.target;
  const std::string in_mode = family.modes.size() == 1 ? family.modes.front() : "in_mode";
  json[target.clean_key] = {{in_mode, Number(score.target_mae_in_mode * target.clean_scale)},
                            {"overall", Number(score.target_mae_overall * target.clean_scale)}};
  json[target.noisy_key] = Number(score.target_noisy_l2);
  json[target.column + "_rel_error"] = Number(score.target_rel_l2);
  for (std::size_t i = 0; i < family.truth_names.size(); ++i)
    json["coverage95"][family.truth_names[i]] = Number(scorer.Coverage(static_cast<int>(i)));
  json["samples"] = {{"in_mode", score.in_mode_samples}, {"overall", score.samples}};
  return json;
}

ordered_json LatencyJson(const LatencyHistogram& histogram) {
  return {{"p50", histogram.QuantileMs(0.5)},
          {"p99", histogram.QuantileMs(0.99)},
          {"p999", histogram.QuantileMs(0.999)},
          {"max", histogram.max_ms()}};
}

ordered_json EstimatorJson(const LiveResult& result) {
  if (!result.status_seen) return nullptr;
  const estimator_status_t& status = result.status;
  return {{"steps", status.step},
          {"misses",
           {{"own", status.missed_own}, {"machine", status.missed_machine}, {"late_data", status.missed_late_data}}},
          {"packs",
           {{"received", status.packs_received},
            {"lost", status.packs_lost},
            {"duplicate", status.packs_duplicate},
            {"reordered", status.packs_reordered},
            {"rejected", status.packs_rejected}}},
          {"degraded", DegradedTexts(status.degraded_flags)}};
}

std::string LatencyText(const LatencyHistogram& histogram) {
  return "p50 " + Significant(histogram.QuantileMs(0.5), 3) + " ms, p99 " + Significant(histogram.QuantileMs(0.99), 3) +
         " ms, max " + Significant(histogram.max_ms(), 3) + " ms";
}

std::string ScoreTable(const PlantFamily& family, const Scorer& scorer, Convention convention) {
  const Score score = scorer.Result(convention);
  TextTable table({"parameter", "mode", "mean |error|", "while known", "relative", "95 % covers", "last"});
  for (std::size_t m = 0; m < family.modes.size(); ++m)
    for (std::size_t i = 0; i < family.truth_names.size(); ++i) {
      const ParameterScore& parameter = score.modes[m][i];
      table.AddRow({family.truth_names[i], family.modes[m], Significant(parameter.mae, 4),
                    Significant(parameter.mae_active, 4), Significant(100.0 * parameter.rel_active, 3) + " %",
                    Significant(100.0 * scorer.Coverage(static_cast<int>(i)), 3) + " %",
                    Significant(parameter.final_value, 5)});
    }
  std::ostringstream out;
  out << "Estimate " << Describe(convention) << ":\n" << table.ToString();
  out << family.target.clean_key << ": " << Significant(score.target_mae_in_mode * family.target.clean_scale, 4)
      << " in mode, " << Significant(score.target_mae_overall * family.target.clean_scale, 4) << " overall; "
      << family.target.noisy_key << ": " << Significant(score.target_noisy_l2, 5) << "\n";
  return out.str();
}

}  // namespace

std::string FormatTable(const Scenario& scenario, const LiveResult& result, const Scorer& scorer) {
  std::ostringstream out;
  out << "\n"
      << (result.interrupted ? "Stopped early. " : "") << "Packs: " << result.packs_sent << " of "
      << result.packs_planned << " sent, " << result.packs_answered << " answered.\n";
  out << "Plant's own lateness: " << LatencyText(result.lateness) << "; " << result.packs_late << " packs late.\n";
  if (result.log_lost > 0) out << result.log_lost << " messages are missing in the log: the disk was too slow.\n";
  if (result.packs_answered == 0) {
    out << "No estimator answered. Start armcmc-estimator with the same --lcm-url and --prefix.\n";
    return out.str();
  }
  out << "Last sample of a pack to arrival of its estimate: " << LatencyText(result.estimate_latency) << ".\n";
  if (result.silences > 0)
    out << "The estimator went silent " << result.silences << " times and came back " << result.returns << " times.\n";
  if (result.status_seen) {
    const estimator_status_t& status = result.status;
    out << "Estimator's deadline misses: " << status.missed_own << " own, " << status.missed_machine << " machine, "
        << status.missed_late_data << " late data.";
    for (const std::string& text : DegradedTexts(status.degraded_flags)) out << " Degraded: " << text << ".";
    out << "\n";
  }
  for (const Convention convention : kConventions) out << "\n" << ScoreTable(*scenario.family, scorer, convention);
  return out.str();
}

void WriteReport(const Scenario& scenario, const PlantOptions& options, const LiveResult& result,
                 const Scorer& scorer) {
  ordered_json json = {{"schema", 1},
                       {"scenario", scenario.name},
                       {"plant", scenario.family->name},
                       {"seed", options.seed},
                       {"run_id", result.run_id},
                       {"period_ms", scenario.pack_period_s() * 1e3},
                       {"interrupted", result.interrupted},
                       {"packs",
                        {{"planned", result.packs_planned},
                         {"sent", result.packs_sent},
                         {"answered", result.packs_answered},
                         {"late", result.packs_late},
                         {"send_errors", result.send_errors}}},
                       {"lateness_ms", LatencyJson(result.lateness)},
                       {"estimate_latency_ms", LatencyJson(result.estimate_latency)},
                       {"convention", "one_pack_later"}};
  json.update(ScoreJson(*scenario.family, scorer, Convention::kOnePackLater));
  json["from_arrival"] = ScoreJson(*scenario.family, scorer, Convention::kFromArrival);
  json["estimator_silences"] = {{"noticed", result.silences}, {"ended", result.returns}};
  json["estimates"] = {{"foreign", result.estimates_foreign}, {"undecodable", result.estimates_undecodable}};
  json["estimator"] = EstimatorJson(result);
  json["faults"] = ordered_json::array();
  for (const Fault& fault : options.faults.faults())
    json["faults"].push_back({{"name", ToString(fault.kind)}, {"pack", fault.pack}, {"amount_ms", fault.amount_ms}});
  if (!options.log_path.empty()) json["log_lost"] = result.log_lost;
  std::ofstream file(options.report_path);
  file << json.dump(2) << "\n";
  file.close();
  if (!file) throw std::runtime_error(options.report_path + ": cannot be written");
}

}  // namespace armcmc::plant_sim
