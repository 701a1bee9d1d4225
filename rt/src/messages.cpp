#include "armcmc/rt/messages.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <type_traits>

namespace armcmc::rt {

static_assert(std::extent_v<decltype(estimate_t::ar_map)> == kMaxReported);
static_assert(std::extent_v<decltype(estimate_t::known_by_mode)> == kMaxModes);
static_assert(std::extent_v<decltype(estimate_t::ar_map_by_mode)> == kMaxModes);
static_assert(std::extent_v<decltype(estimate_t::ar_map_by_mode), 1> == kMaxReported);
static_assert(estimate_t::MAX_PARAMS == kMaxReported && estimate_t::MAX_MODES == kMaxModes);
static_assert(std::extent_v<decltype(posterior_t::lo)> == kMaxReported);
static_assert(std::extent_v<decltype(posterior_t::density)> == kMaxReported);
static_assert(std::extent_v<decltype(posterior_t::density), 1> == kHistogramBins);
static_assert(std::extent_v<decltype(change_t::drift_rate)> == kMaxModes);
static_assert(std::extent_v<decltype(change_t::drift_rate), 1> == kMaxReported);
static_assert(change_t::MAX_PARAMS == kMaxReported && change_t::MAX_MODES == kMaxModes);
static_assert(estimate_t::DECISION_HOLD == static_cast<int>(Decision::kHold));
static_assert(estimate_t::DECISION_REINFORCEMENT == static_cast<int>(Decision::kReinforcement));
static_assert(estimate_t::DECISION_MODIFICATION == static_cast<int>(Decision::kModification));

namespace {

template <std::size_t kSize>
void FillText(std::string_view text, std::uint8_t (&field)[kSize]) noexcept {
  // One byte stays zero, so that a reader may take it as a C string.
  const std::size_t n = std::min(text.size(), kSize - 1);
  std::transform(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(n), field,
                 [](char c) { return static_cast<std::uint8_t>(c); });
}

/// The first characters; what substr() does, which may throw.
constexpr std::string_view Head(std::string_view text, std::size_t size) noexcept {
  return {text.data(), std::min(size, text.size())};
}

/// A name that is too long is cut; where that would make it another one's, it keeps its head and its tail around a "~":
/// those of one effect differ at the end.
template <std::size_t kSize>
void FillName(const StepEngine& engine, int index, std::uint8_t (&field)[kSize]) noexcept {
  constexpr std::size_t kTail = 6, kHead = kSize - 2 - kTail;
  std::string_view name = engine.reported(index).name;
  bool shared = false;
  for (int i = 0; i < engine.num_reported(); ++i)
    shared = shared || (i != index && Head(engine.reported(i).name, kSize - 1) == Head(name, kSize - 1));
  if (name.size() < kSize || !shared) {
    FillText(name, field);
    return;
  }
  FillText(Head(name, kHead), field);
  field[kHead] = static_cast<std::uint8_t>('~');
  name.remove_prefix(name.size() - kTail);
  std::transform(name.begin(), name.end(), field + kHead + 1, [](char c) { return static_cast<std::uint8_t>(c); });
}

/// Mode whose parameters are reported; guards the index against a mode that does not exist.
const ModeEstimate& ReportedMode(const Estimate& estimate) noexcept {
  return estimate.modes[static_cast<std::size_t>(std::clamp(estimate.report_mode, 0, kMaxModes - 1))];
}

}  // namespace

void FillEstimate(const StepOutput& output, const StepEngine& engine, std::int64_t utime,
                  estimate_t* message) noexcept {
  const Estimate& e = output.estimate;
  const ModeEstimate& mode = ReportedMode(e);
  const int num_reported = std::clamp(engine.num_reported(), 0, kMaxReported);
  const int num_modes = std::clamp(engine.num_modes(), 0, kMaxModes);
  *message = estimate_t{};
  message->utime = utime;
  message->seq = output.info.seq;
  message->run_id = output.info.run_id;
  message->t_last_ns = e.t_last_ns;
  message->t_release_ns = output.info.times.release_ns;
  message->t_done_ns = output.info.times.end_ns[IndexOf(Stage::kExecute)];
  message->t_last_s = e.t_last_s;
  message->plant_kind = static_cast<std::int32_t>(engine.plant());
  message->mode = e.mode;
  message->in_contact = e.active ? 1 : 0;
  message->known = mode.known ? 1 : 0;
  message->decision = static_cast<std::int8_t>(mode.updated ? mode.decision : Decision::kHold);
  message->truncated = output.info.status == Status::kTruncated ? 1 : 0;
  message->n_params = num_reported;
  message->n_modes = num_modes;
  for (int i = 0; i < num_reported; ++i) {
    const MarginalSummary& marginal = mode.marginal[static_cast<std::size_t>(i)];
    const ReportedQuantity quantity = engine.reported(i);
    FillName(engine, i, message->param_name[i]);
    FillText(quantity.unit, message->param_unit[i]);
    if (!mode.known) continue;
    message->ar_map[i] = marginal.ar_map;
    message->ar_ap[i] = marginal.ar_ap;
    message->sd[i] = marginal.sd;
    message->q025[i] = marginal.q025;
    message->q25[i] = marginal.q25;
    message->q50[i] = marginal.q50;
    message->q75[i] = marginal.q75;
    message->q975[i] = marginal.q975;
  }
  for (int m = 0; m < num_modes; ++m) {
    const ModeEstimate& other = e.modes[static_cast<std::size_t>(m)];
    message->known_by_mode[m] = other.known ? 1 : 0;
    message->draws_by_mode[m] = other.updated ? other.draws : 0;
    for (int i = 0; other.known && i < num_reported; ++i) {
      message->ar_map_by_mode[m][i] = other.marginal[static_cast<std::size_t>(i)].ar_map;
      message->sd_by_mode[m][i] = other.marginal[static_cast<std::size_t>(i)].sd;
    }
  }
  message->lambda = mode.lambda;
  message->zeta = mode.zeta;
  message->zeta_threshold = mode.zeta_threshold;
  message->k_min = mode.k_min;
  message->draws = mode.draws;
  message->ess = mode.ess;
  message->kish_ess = mode.kish_ess;
  message->acceptance = mode.acceptance;
  message->log_evidence = mode.log_evidence;
  message->p_changed = mode.p_changed;
  message->noise_std = mode.noise_std;
  message->y_pred = e.y_pred;
  message->y_lo = e.y_lo;
  message->y_hi = e.y_hi;
  message->y_rmse = e.y_rmse;
}

void FillPosterior(const StepOutput& output, const StepEngine& engine, std::int64_t utime,
                   posterior_t* message) noexcept {
  const ModeEstimate& mode = ReportedMode(output.estimate);
  const int num_reported = std::clamp(engine.num_reported(), 0, kMaxReported);
  *message = posterior_t{};
  message->utime = utime;
  message->seq = output.info.seq;
  message->run_id = output.info.run_id;
  message->plant_kind = static_cast<std::int32_t>(engine.plant());
  message->mode = output.estimate.report_mode;
  message->known = mode.known ? 1 : 0;
  message->n_params = num_reported;
  message->n_bins = kHistogramBins;
  for (int i = 0; mode.known && i < num_reported; ++i) {
    const MarginalSummary& marginal = mode.marginal[static_cast<std::size_t>(i)];
    message->lo[i] = marginal.histogram_lo;
    message->hi[i] = marginal.histogram_hi;
    std::copy(marginal.density.begin(), marginal.density.end(), message->density[i]);
  }
}

void FillChange(const StepOutput& output, const StepEngine& engine, std::int64_t utime, change_t* message) noexcept {
  const Estimate& e = output.estimate;
  const int num_reported = std::clamp(engine.num_reported(), 0, kMaxReported);
  const int num_modes = std::clamp(engine.num_modes(), 0, kMaxModes);
  *message = change_t{};
  message->change_utime = utime;
  message->seq = output.info.seq;
  message->run_id = output.info.run_id;
  message->plant_kind = static_cast<std::int32_t>(engine.plant());
  message->mode = e.report_mode;
  message->n_modes = num_modes;
  message->n_params = num_reported;
  for (int i = 0; i < num_reported; ++i) {
    FillName(engine, i, message->param_name[i]);
    FillText(engine.reported(i).unit, message->param_unit[i]);
  }
  for (int m = 0; m < num_modes; ++m) {
    FillText(engine.mode_name(m), message->mode_name[m]);
    const ModeEstimate& mode = e.modes[static_cast<std::size_t>(m)];
    if (!mode.known) continue;
    message->known[m] = 1;
    message->updated[m] = mode.updated ? 1 : 0;
    message->p_drifted[m] = mode.p_drifted;
    message->p_changed[m] = mode.p_changed;
    message->p_persisted[m] = std::clamp(1.0 - mode.p_drifted - mode.p_changed, 0.0, 1.0);
    std::copy_n(mode.drift_rate.begin(), num_reported, message->drift_rate[m]);
  }
}

void FillStatus(const StatusContext& context, const RtSettings& settings, const Counters& counters,
                const DeadlineMonitor& monitor, estimator_status_t* message) noexcept {
  *message = estimator_status_t{};
  message->utime = context.utime;
  message->step = counters.execute.steps.Get();
  message->last_seq = counters.execute.last_seq.Get();
  message->t_status_ns = context.now_ns;
  message->period_ns = settings.period_ns;
  message->deadline_ns = settings.deadline_ns;
  if (context.output != nullptr) {
    const StepTimes& times = context.output->info.times;
    message->collect_ns = times.Duration(Stage::kCollect);
    message->adjust_ns = times.Duration(Stage::kAdjust);
    message->execute_ns = times.Duration(Stage::kExecute);
    message->end_to_end_ns = times.EndToEnd();
    message->slack_ns = times.Slack();
    message->miss_cause = static_cast<std::int32_t>(context.output->miss);
  }
  message->witness_max_ns = context.witness_max_ns;
  message->missed_own = monitor.misses(MissCause::kOwn);
  message->missed_machine = monitor.misses(MissCause::kMachine);
  message->missed_late_data = monitor.misses(MissCause::kLateData);
  const auto& collect = counters.collect;
  message->packs_received = collect.received.Get();
  message->packs_lost = collect.lost.Get();
  message->packs_duplicate = collect.duplicate.Get();
  message->packs_reordered = collect.reordered.Get();
  message->packs_rejected = counters.Rejected();
  message->rejected_size = counters.Rejected(RejectGroup::kSize);
  message->rejected_type = counters.Rejected(RejectGroup::kType);
  message->rejected_value = counters.Rejected(RejectGroup::kValue);
  message->packs_dropped = counters.Dropped();
  message->publish_errors = counters.publish.errors.Get() + counters.execute.unpublished.Get();
  message->silent_periods = collect.silent_periods.Get();
  message->plant_restarts = collect.restarts.Get();
  message->truncated_steps = counters.adjust.truncated.Get();
  message->fault_flags = context.fault_flags;
  message->degraded_flags = context.degraded_flags;
  const GapState& gap = context.gap;
  message->gap_watched = gap.watched ? 1 : 0;
  message->gap_suspected = gap.suspected ? 1 : 0;
  message->gap_check = gap.check;
  FillText(gap.where.view(), message->gap_where);
  message->gap_log_evidence = gap.log_evidence;
  message->gap_log_threshold = gap.log_threshold;
  message->gap_share = gap.share;
  message->gap_since_seq = gap.since_seq;
  message->gap_alarm_seq = gap.alarm_seq;
}

}  // namespace armcmc::rt
