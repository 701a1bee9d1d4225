#include "followed_drift.hpp"

#include <array>

#include "armcmc/estimator.hpp"
#include "armcmc/replay/replay.hpp"
#include "armcmc/support/text_table.hpp"

namespace armcmc::gap {
namespace {

using support::Significant;

constexpr int kFewestBlocks = 4;     // of the gap watch: small gaps take that long to detect
constexpr double kMostOfThem = 0.5;  // of the packs with data

}  // namespace

FollowedDrift FollowDrift(const EstimatorSettings& base, const replay::SourceRequest& packs) {
  Estimator estimator(base);
  replay::SourceRequest request = packs;
  request.plant = estimator.plant();
  request.num_inputs = estimator.num_inputs();
  request.described = base.plant;
  for (int mode = 0; mode < estimator.num_modes(); ++mode) request.mode_names.emplace_back(estimator.mode_name(mode));
  const auto source = replay::OpenSource(request);
  std::array<double, kMaxReported> rate{};
  double counted = 0.0, drifting = 0.0;
  const replay::ReplaySummary summary =
      replay::Replay(source.get(), &estimator, [&](const replay::RecordedPack&, const Estimate& e) {
        const ModeEstimate& mode = e.modes[static_cast<std::size_t>(e.report_mode)];
        if (!mode.updated) return;
        counted += 1.0;
        if (!(mode.p_drifted > 0.5)) return;
        drifting += 1.0;
        for (std::size_t i = 0; i < rate.size(); ++i) rate[i] += mode.drift_rate[i];
      });
  FollowedDrift result;
  if (counted > 0.0) result.share = drifting / counted;
  const GapState& gap = summary.last.gap;
  result.followed = result.share > kMostOfThem && gap.num_blocks >= kFewestBlocks && !gap.suspected;
  for (int i = 0; drifting > 0.0 && i < estimator.num_reported(); ++i) {
    const ReportedQuantity quantity = estimator.reported(i);
    if (i > 0) result.rates += ", ";
    result.rates.append(quantity.name)
        .append(" ")
        .append(Significant(rate[static_cast<std::size_t>(i)] / drifting, 2))
        .append(" ");
    if (quantity.unit != "-") result.rates.append(quantity.unit).append(" ");
    result.rates += "per s";
  }
  return result;
}

void AttributeToDrift(const FollowedDrift& drift, Result* result) {
  if (!drift.followed || result->verdict != Verdict::kUnnamed) return;
  result->verdict = Verdict::kNone;
  result->sentence = "The parameters drift, and the estimator tracks the drift; nothing else is missing.";
  result->probability_none += result->probability_unnamed;
  result->probability_unnamed = 0.0;
  result->sparse.clear();
  result->notes.push_back(
      "with constant parameters no effect of the catalogue explains these data; the estimator gives drift a "
      "probability above one half in " +
      Significant(100.0 * drift.share, 2) + " % of the packs (" + drift.rates +
      "), and its gap watch detects nothing else");
}

}  // namespace armcmc::gap
