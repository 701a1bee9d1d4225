#include <cmath>

#include "armcmc/tables/plants/registry.hpp"
#include "armcmc/tables/report.hpp"

namespace armcmc::tables {
namespace {

using nlohmann::ordered_json;

ordered_json Number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(); }

constexpr std::array<const char*, 3> kParameters{"K", "B", "p"};

ordered_json Parameters(const std::array<double, 3>& v) {
  ordered_json out;
  for (std::size_t d = 0; d < 3; ++d) out[kParameters[d]] = Number(v[d]);
  return out;
}

ordered_json DriftJson(const DriftScore& s, const std::vector<const char*>& names) {
  ordered_json out = {{"share", Number(s.share)}};
  for (std::size_t d = 0; d < names.size(); ++d) out["rate_per_s"][names[d]] = Number(s.rate[d]);
  return out;
}

ordered_json ContactJson(const Row& row) {
  const ContactScore& s = row.contact;
  ordered_json out;
  out["label"] = row.label;
  out["online"] = row.online;
  out["mae_contact"] = Parameters(s.mae_contact);
  out["mae_active_contact"] = Parameters(s.mae_active_contact);
  out["clean_force_mae_mN"] = {{"contact", s.force_contact_mn}, {"overall", s.force_overall_mn}};
  out["noisy_force_l2_N"] = s.noisy_force_l2_n;
  if (row.has_intervals) {
    const std::array<const char*, 3> names{"50", "90", "95"};
    for (std::size_t l = 0; l < names.size(); ++l) {
      out[std::string("coverage") + names[l]] = Parameters(s.coverage[l]);
      out[std::string("width") + names[l]] = Parameters(s.width[l]);
      out[std::string("coverage") + names[l] + "_standard_error"] = Parameters(row.coverage_error[l]);
      ordered_json& verdict = out[std::string("coverage") + names[l] + "_verdict"];
      for (std::size_t d = 0; d < 3; ++d)
        verdict[kParameters[d]] = NameOf(JudgeCoverage(s.coverage[l][d], l, row.coverage_error[l][d]));
    }
    out["draws"] = s.mean_draws;
  }
  if (row.key.starts_with("armcmc")) {
    out["modifications_after_first_pack"] = s.false_modifications;
    out["drift"] = DriftJson(s.drift, {"K", "B", "p"});
  }
  out["adjust_ms"] = {{"median", s.median_ms}, {"max", s.max_ms}};
  return out;
}

ordered_json ActuatorJson(const Row& row) {
  const ActuatorScore& s = row.actuator;
  const auto coverage = [](const std::array<std::array<double, 2>, 2>& c) {
    return ordered_json{{"u_c", {{"g", c[0][0]}, {"theta2", c[0][1]}}}, {"u_d", {{"g", c[1][0]}, {"theta2", c[1][1]}}}};
  };
  ordered_json out = {{"label", row.label},
                      {"online", row.online},
                      {"g_rel_error", {{"u_c", Number(s.g_rel_error[0])}, {"u_d", Number(s.g_rel_error[1])}}},
                      {"theta1_l2", Number(s.theta1_l2)},
                      {"theta2_l2", Number(s.theta2_l2)},
                      {"alpha_l2", Number(s.alpha_l2)},
                      {"alpha_restarted_l2", Number(s.alpha_restarted_l2)},
                      {"flow_rel_error", Number(s.flow_rel_error)},
                      {"coverage50", coverage(s.coverage50)},
                      {"coverage95", coverage(s.coverage95)},
                      {"adjust_ms", {{"median", s.median_ms}, {"max", s.max_ms}}}};
  if (row.key.starts_with("armcmc"))
    for (std::size_t m = 0; m < 2; ++m) out["drift"][m == 0 ? "u_c" : "u_d"] = DriftJson(s.drift[m], {"g", "theta2"});
  return out;
}

ordered_json PaperJson(const std::vector<PaperRow>& rows, const std::vector<const char*>& names) {
  ordered_json out;
  for (const PaperRow& row : rows)
    for (std::size_t i = 0; i < names.size(); ++i) out[row.key][names[i]] = Number(row.values[i]);
  return out;
}

}  // namespace

ordered_json ToJson(const Result& result) {
  ordered_json out;
  out["schema"] = 1;
  out["data"] = {{kContact.key(), result.contact_data}, {kActuator.key(), result.actuator_data}};
  for (const Experiment& e : result.experiments) {
    ordered_json& entry = out[e.key];
    entry["title"] = e.title;
    entry["seeds"] = e.seeds;
    for (const Row& row : e.rows)
      entry["methods"][row.key] = kContact.Is(e.plant) ? ContactJson(row) : ActuatorJson(row);
    if (e.key == kContact.key()) {
      entry["published"] = PaperJson(PublishedContact(), {"mae_K", "mae_B", "mae_p", "printed_F_e_mN"});
      entry["authors_stored"] = PaperJson(StoredContact(), {"mae_K", "mae_B", "mae_p", "clean_force_mae_mN_contact",
                                                            "clean_force_mae_mN_overall", "noisy_force_l2_N"});
      entry["note"] = ContactNote();
    } else if (e.key == kActuator.key()) {
      entry["published"] = PaperJson(PublishedActuator(), {"theta1_l2", "theta2_l2_1e-6", "alpha_l2"});
      entry["authors_stored"] =
          PaperJson(StoredActuator(), {"theta1_l2", "theta2_l2_1e-6", "alpha_l2", "flow_rel_error"});
      entry["note"] = ActuatorNote();
    }
  }
  for (const LikelihoodCell& cell : result.likelihoods) {
    ordered_json& entry = out["likelihoods"][cell.noise][cell.assumed] = ContactJson(cell.row);
    entry["seeds"] = cell.seeds;
  }
  if (!result.baselines) return out;  // nobody to lose to
  out["rows_lost"] = LostRows(result);
  out["rows_lost_note"] = LostRowsNote();
  return out;
}

}  // namespace armcmc::tables
