#include "armcmc/watch/step_text.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "armcmc/support/text_table.hpp"
#include "armcmc/watch/names.hpp"

namespace armcmc::watch {
namespace {

using Json = nlohmann::ordered_json;

double Milliseconds(std::int64_t ns) { return 1e-6 * static_cast<double>(ns); }

Json Parameters(const WatchState& state) {
  Json parameters = Json::object();
  const estimate_t& e = *state.estimate;
  const int n = std::clamp<int>(e.n_params, 0, estimate_t::MAX_PARAMS);
  for (int i = 0; i < n; ++i) {
    Json& p = parameters[FieldText(e.param_name[i], 16)];
    p["unit"] = FieldText(e.param_unit[i], 16);
    for (const auto& [key, values] : {std::pair{"mean", e.ar_ap}, std::pair{"ar_map", e.ar_map}, std::pair{"sd", e.sd},
                                      std::pair{"q025", e.q025}, std::pair{"q50", e.q50}, std::pair{"q975", e.q975}}) {
      p[key] = e.known != 0 ? Json(values[i]) : Json(nullptr);
    }
    if (state.truth) {
      const double truth = TrueValue(*state.truth, e, i);
      if (std::isfinite(truth)) p["truth"] = truth;
    }
  }
  return parameters;
}

Json Change(const change_t& c) {
  Json modes = Json::object();
  const int n = std::clamp<int>(c.n_params, 0, change_t::MAX_PARAMS);
  for (int m = 0; m < std::clamp<int>(c.n_modes, 0, change_t::MAX_MODES); ++m) {
    if (c.known[m] == 0) continue;
    Json& mode = modes[FieldText(c.mode_name[m], 16)];
    mode = {{"persisted", c.p_persisted[m]}, {"drifted", c.p_drifted[m]}, {"changed", c.p_changed[m]}};
    for (int i = 0; i < n; ++i)
      mode["drift_rate"][FieldText(c.param_name[i], 16)] = {{"value", c.drift_rate[m][i]},
                                                            {"unit", PerSecond(FieldText(c.param_unit[i], 16))}};
  }
  return modes;
}

Json Sampler(const estimate_t& e) {
  return {{"mode", ModeName(e.plant_kind, e.mode)},
          {"decision", DecisionName(e.decision)},
          {"lambda", e.lambda},
          {"zeta", e.zeta},
          {"zeta_threshold", e.zeta_threshold},
          {"acceptance", e.acceptance},
          {"ess", e.ess},
          {"draws", e.draws},
          {"y_pred", e.y_pred},
          {"y_rmse", e.y_rmse}};
}

}  // namespace

std::string StepLine(const WatchState& state) {
  const estimator_status_t& s = *state.status;
  std::string line = "pack " + std::to_string(s.last_seq);
  if (state.estimate) {
    const estimate_t& e = *state.estimate;
    line += "  " + ModeName(e.plant_kind, e.mode);
    const int n = std::clamp<int>(e.n_params, 0, estimate_t::MAX_PARAMS);
    for (int i = 0; i < n; ++i) {
      line += "  " + FieldText(e.param_name[i], 16) + " ";
      line += e.known != 0 ? support::Significant(e.ar_ap[i], 5) + " +- " + support::Significant(e.sd[i], 2) : "?";
    }
    line += "  zeta " + support::Significant(e.zeta, 2) + "/" + support::Significant(e.zeta_threshold, 3) +
            "  lambda " + support::Significant(e.lambda, 3) + "  ESS " + support::Significant(e.ess, 4);
  }
  if (state.change) {
    const int mode = std::clamp<int>(state.change->mode, 0, change_t::MAX_MODES - 1);
    if (state.change->known[mode] != 0)
      line += "  drifted " + support::Significant(100.0 * state.change->p_drifted[mode], 3) + " %";
  }
  line += "  " + support::Significant(Milliseconds(s.end_to_end_ns), 3) + " of " +
          support::Significant(Milliseconds(s.deadline_ns), 3) + " ms  missed " + std::to_string(s.missed_own) + "/" +
          std::to_string(s.missed_machine) + "/" + std::to_string(s.missed_late_data);
  if (s.packs_lost > 0) line += "  lost " + std::to_string(s.packs_lost);
  if (s.packs_rejected > 0) line += "  rejected " + std::to_string(s.packs_rejected);
  if (s.fault_flags != 0) line += "  FAULTS " + Joined(FaultWords(s.fault_flags));
  if (s.degraded_flags != 0) line += "  DEGRADED " + Joined(DegradedWords(s.degraded_flags));
  if (s.gap_suspected != 0) line += "  MODEL GAP " + FieldText(s.gap_where, 32);
  return line;
}

std::string StepJson(const WatchState& state) {
  const estimator_status_t& s = *state.status;
  Json json = {{"step", s.step}, {"pack", s.last_seq}, {"utime", s.utime}};
  if (state.estimate) {
    json["parameters"] = Parameters(state);
    json.update(Sampler(*state.estimate));
  }
  if (state.change) json["change"] = Change(*state.change);
  json["stage_ms"] = {{"collect", Milliseconds(s.collect_ns)},
                      {"adjust", Milliseconds(s.adjust_ns)},
                      {"execute", Milliseconds(s.execute_ns)},
                      {"end_to_end", Milliseconds(s.end_to_end_ns)}};
  json["deadline_ms"] = Milliseconds(s.deadline_ns);
  json["slack_ms"] = Milliseconds(s.slack_ns);
  json["misses"] = {{"own", s.missed_own}, {"machine", s.missed_machine}, {"late_data", s.missed_late_data}};
  json["packs"] = {{"received", s.packs_received},   {"lost", s.packs_lost},         {"duplicate", s.packs_duplicate},
                   {"reordered", s.packs_reordered}, {"rejected", s.packs_rejected}, {"dropped", s.packs_dropped}};
  json["faults"] = FaultWords(s.fault_flags);
  json["degraded"] = DegradedWords(s.degraded_flags);
  json["gap"] = {{"watched", s.gap_watched != 0},
                 {"suspected", s.gap_suspected != 0},
                 {"where", FieldText(s.gap_where, 32)},
                 {"log_evidence", s.gap_log_evidence},
                 {"log_threshold", s.gap_log_threshold}};
  json["bus"] = {{"foreign", state.bus.foreign}, {"undecodable", state.bus.undecodable}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace armcmc::watch
