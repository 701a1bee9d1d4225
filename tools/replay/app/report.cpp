#include "report.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "armcmc/gap_watch/gap_block.hpp"
#include "armcmc/plant/program.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/text_table.hpp"

namespace armcmc::replay {
namespace {

/// Of a plant that seems to change all the time; else empty.
std::string UnsettledText(const ReplaySummary& summary) {
  constexpr std::int64_t kLeast = 10;  // packs with a modification
  constexpr std::int64_t kOneIn = 5;   // of those that say something
  const std::int64_t updated = summary.packs - summary.held;
  if (summary.modifications < kLeast || kOneIn * summary.modifications < updated) return {};
  return "note: " + std::to_string(summary.modifications) + " of " + std::to_string(updated) +
         " packs look as if the parameters had just changed: the law may be missing something (armcmc-gap), or the "
         "noise "
         "may be larger than assumed (--calibrate)\n";
}

/// Why the gap watch has no verdict.
std::string NoVerdictText(const Estimator& estimator, const GapState& gap) {
  const EstimatorSettings& settings = estimator.settings();
  if (!settings.gap_watch.enabled) return "not watched, since [gap_watch] enabled = false";
  if (!gap.watched)
    return "not watched, since there are more than " + std::to_string(kGapColumns) +
           " parameters in all modes together";
  const bool states = settings.plant != nullptr && settings.plant->states().size() > 0;
  return "not judged, since too few packs were usable: a verdict takes " + std::to_string(kGapBlockPacks) +
         " blocks of data in one run, each of " +
         (states ? "as many packs as one pack has room for" : "a pack of 0.1 s or more, or of several shorter ones") +
         ", and half as many again while they are analysed";
}

}  // namespace

std::string SummaryText(const Estimator& estimator, const PackSource& source, const ReplaySummary& summary) {
  using support::Significant;
  std::ostringstream out;
  const PackCounts counts = source.counts();
  out << summary.packs << " packs (" << Significant(summary.data_s, 4) << " s), " << summary.held << " uninformative, "
      << summary.modifications << (summary.modifications == 1 ? " modification, " : " modifications, ")
      << summary.truncated << " truncated; lost " << counts.lost << ", duplicate " << counts.duplicate << ", reordered "
      << counts.reordered << ", rejected " << counts.rejected + summary.refused << ", unused " << counts.unused << '\n';
  for (const std::string& note : source.notes()) out << "note: " << note << '\n';
  out << UnsettledText(summary);

  support::TextTable table({"mode", "quantity", "estimate", "sd", "95 % from", "to", "unit"});
  bool any_known = false;
  for (int m = 0; m < estimator.num_modes(); ++m) {
    const ModeEstimate& mode = summary.last.modes[static_cast<std::size_t>(m)];
    any_known = any_known || mode.known;
    for (int i = 0; i < estimator.num_reported() && mode.known; ++i) {
      const MarginalSummary& q = mode.marginal[static_cast<std::size_t>(i)];
      table.AddRow({std::string(estimator.mode_name(m)), std::string(estimator.reported(i).name),
                    Significant(q.ar_map, 5), Significant(q.sd, 2), Significant(q.q025, 5), Significant(q.q975, 5),
                    std::string(estimator.reported(i).unit)});
    }
  }
  const GapState& gap = summary.last.gap;
  if (gap.num_blocks > 0) {
    out << (gap.suspected ? "GAP SUSPECTED since pack " + std::to_string(gap.since_seq) + " (alarm at pack " +
                                std::to_string(gap.alarm_seq) + "), seen in " + std::string(gap.where.view())
                          : std::string("gap between model and plant: none suspected"))
        << "; log evidence " << Significant(gap.log_evidence, 3) << ", threshold " << Significant(gap.log_threshold, 3)
        << '\n';
  } else {
    out << "gap between model and plant: " << NoVerdictText(estimator, gap) << "; armcmc-gap judges a recording\n";
  }
  out << (any_known ? table.ToString()
                    : std::string("nothing is known: no pack carried information about a parameter\n"));
  if (summary.packs > 0 && summary.compute_s > 0.0)
    out << "computed in " << Significant(summary.compute_s, 3) << " s, "
        << Significant(summary.data_s / summary.compute_s, 3) << " times real time, "
        << Significant(1e3 * summary.compute_s / static_cast<double>(summary.packs), 3) << " ms a pack on "
        << InstructionSet() << '\n';
  return out.str();
}

std::string VerificationText(const Verification& v, const PackSource& source) {
  std::ostringstream out;
  if (v.undecodable > 0)
    out << v.undecodable << " messages of the estimator are of a type that this version does not know\n";
  if (v.without_pack > 0) out << v.without_pack << " recorded estimates have no pack in the log\n";
  if (v.equal()) {
    out << "verified: " << v.compared << " recorded messages are bit-identical\n";
  } else if (v.compared == 0) {
    out << "NOT VERIFIED: no recorded estimate belongs to a pack of the log\n";
  } else {
    out << "NOT EQUAL: " << v.different << " of " << v.compared << " recorded messages differ; first, "
        << v.first_difference << '\n';
    if (source.counts().lost > 0 || source.damage().any() || v.without_pack > 0)
      out << "packs are missing in the log: from the first of them on the two runs have learnt from different data\n";
    out << "the same configuration, model (--model) and seed (--seed) as in the live run are needed\n";
  }
  return out.str();
}

void WriteReport(const std::filesystem::path& path, const Estimator& estimator, const PackSource& source,
                 const ReplaySummary& summary, const std::optional<Verification>& verification) {
  using nlohmann::ordered_json;
  const PackCounts counts = source.counts();
  ordered_json report;
  report["schema"] = 1;
  report["program"] = "armcmc-replay " + support::Version();
  report["model"] = estimator.settings().model;
  report["seed"] = estimator.settings().sampler.seed;
  report["packs"] = {{"used", summary.packs},
                     {"held", summary.held},
                     {"modifications", summary.modifications},
                     {"truncated", summary.truncated},
                     {"lost", counts.lost},
                     {"duplicate", counts.duplicate},
                     {"reordered", counts.reordered},
                     {"rejected", counts.rejected + summary.refused},
                     {"unused", counts.unused}};
  ordered_json modes = ordered_json::object();
  ordered_json change = ordered_json::object();
  for (int m = 0; m < estimator.num_modes(); ++m) {
    const ModeEstimate& mode = summary.last.modes[static_cast<std::size_t>(m)];
    if (!mode.known) continue;
    ordered_json& parameters = modes[std::string(estimator.mode_name(m))];
    for (int i = 0; i < estimator.num_reported(); ++i) {
      const MarginalSummary& q = mode.marginal[static_cast<std::size_t>(i)];
      parameters[std::string(estimator.reported(i).name)] = {
          {"ar_map", q.ar_map}, {"ar_ap", q.ar_ap}, {"sd", q.sd},
          {"q025", q.q025},     {"q975", q.q975},   {"unit", estimator.reported(i).unit}};
    }
    ordered_json& probabilities = change[std::string(estimator.mode_name(m))];
    probabilities = {{"p_persisted", std::clamp(1.0 - mode.p_drifted - mode.p_changed, 0.0, 1.0)},
                     {"p_drifted", mode.p_drifted},
                     {"p_changed", mode.p_changed}};
    for (int i = 0; i < estimator.num_reported(); ++i)
      probabilities["drift_rate_per_s"][std::string(estimator.reported(i).name)] =
          mode.drift_rate[static_cast<std::size_t>(i)];
  }
  report["estimates"] = modes;
  report["change"] = change;
  const GapState& gap = summary.last.gap;
  report["gap"] = {
      {"watched", gap.watched},           {"suspected", gap.suspected},         {"where", gap.where.view()},
      {"log_evidence", gap.log_evidence}, {"log_threshold", gap.log_threshold}, {"share_of_excess_error", gap.share},
      {"since_pack", gap.since_seq},      {"alarm_pack", gap.alarm_seq},        {"blocks", gap.num_blocks}};
  const support::LcmLogDamage damage = source.damage();
  report["log_damage"] = {{"places_skipped", damage.resyncs},
                          {"bytes_skipped", damage.skipped_bytes},
                          {"events_missing", damage.missing_events},
                          {"wrong_numbers", damage.wrong_numbers},
                          {"cut_off", damage.cut_off}};
  if (verification) {
    report["verified"] = {{"equal", verification->equal()},
                          {"compared", verification->compared},
                          {"different", verification->different},
                          {"undecodable", verification->undecodable},
                          {"without_pack", verification->without_pack},
                          {"first_difference", verification->first_difference}};
  }
  report["data_s"] = summary.data_s;
  report["compute_s"] = summary.compute_s;
  report["instruction_set"] = InstructionSet();
  report["notes"] = source.notes();
  std::ofstream file(path);
  file << report.dump(2) << '\n';
  if (!file.flush()) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace armcmc::replay
