// The execute stage: estimates, predicted output with its band, the gap watch.

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimator_impl.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr GapState kNothingWatched{};

}  // namespace

void Estimator::Impl::ShareVector(Estimate* e) noexcept {
  std::size_t newest = kMaxModes;
  for (std::size_t m = 0; m < static_cast<std::size_t>(info.num_modes); ++m)
    if (e->modes[m].updated && (newest == kMaxModes || static_cast<int>(m) == e->mode)) newest = m;
  if (newest == kMaxModes) return;
  for (std::size_t m = 0; m < static_cast<std::size_t>(info.num_modes); ++m) {
    if (m == newest) continue;
    e->modes[m].known = last_estimates[m].known = e->modes[newest].known;
    e->modes[m].noise_std = last_estimates[m].noise_std = e->modes[newest].noise_std;
    e->modes[m].marginal = last_estimates[m].marginal = e->modes[newest].marginal;
    band_theta[m] = band_theta[newest];
  }
}

void Estimator::Impl::PredictOutput(const AdjustResult& result, Estimate* e) noexcept {
  const DataPack& pack = result.pack;
  if (!trajectory.empty()) {
    std::fill_n(e->y_shown.begin(), static_cast<std::size_t>(pack.num_samples), kUnknown);
    std::fill_n(e->y_shown_free_run.begin(), static_cast<std::size_t>(pack.num_samples), kUnknown);
  } else if (info.described != nullptr) {
    PredictDescribed(result, e);
  } else if (composition.effects_on_output()) {
    PredictShown(result, e);
  } else {
    predictor->Predict(pack, shown[1], &e->y_shown, &e->y_shown_free_run);
  }
  const auto last = static_cast<std::size_t>(pack.num_samples - 1);
  e->y_free_run = e->y_shown_free_run[last];
  e->y_pred = e->y_lo = e->y_hi = 0.0;
  e->y_rmse = 0.0;

  // Fit of the posterior after the pack to the pack itself, over its known modes; unit of the target.
  double square = 0.0;
  int count = 0;
  for (int m = 0; m < info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    const ModeDraws& draws = result.modes[i];
    if (draws.updated) StoreBandDraws(m, draws);
    if (!last_estimates[i].known) continue;
    PrepareMode(pack, result.effects, m, &execute_data);
    if (execute_data.num_samples == 0) continue;
    kernels.predict(model, execute_data, band_theta[i], &band_prediction);
    for (int n = 0; n < execute_data.num_samples; ++n) {
      double mean = 0.0;
      for (const double v : band_prediction.value[static_cast<std::size_t>(n)]) mean += v;
      const double error = execute_data.target[static_cast<std::size_t>(n)] - mean / kBandDraws;
      square += error * error;
      ++count;
    }
    if (trajectory.empty() && (m == e->mode || composition.effects_on_output())) PredictLastSample(pack, m, e);
  }
  if (!trajectory.empty())
    PredictSimulated(pack, e);
  else if (info.described != nullptr && (!e->active || !info.described->LawIsOutput(e->mode)))
    e->y_pred = e->y_lo = e->y_hi = e->y_shown[last];
  e->y_rmse = count > 0 ? std::sqrt(square / count) : 0.0;
  if (simulates_output() && !e->active) e->y_pred = e->y_lo = e->y_hi = e->y_shown[last];
}

void Estimator::Impl::PredictShown(const AdjustResult& result, Estimate* e) noexcept {
  const auto samples = static_cast<std::size_t>(result.pack.num_samples);
  if (!shown[1].known[0]) {
    std::fill_n(e->y_shown.begin(), samples, kUnknown);
  } else {
    for (std::size_t d = 0; d < static_cast<std::size_t>(info.num_parameters); ++d)
      shown_theta.value[d].fill(shown[1].theta[0][d]);
    PrepareMode(result.pack, result.effects, 0, &execute_data);
    kernels.predict(model, execute_data, shown_theta, &band_prediction);
    for (std::size_t n = 0; n < samples; ++n) e->y_shown[n] = band_prediction.value[n][0];
  }
  std::copy_n(e->y_shown.begin(), samples, e->y_shown_free_run.begin());
}

void Estimator::Impl::PredictDescribed(const AdjustResult& result, Estimate* e) noexcept {
  const PlantPack& plant = result.effects.described;
  const auto samples = static_cast<std::size_t>(result.pack.num_samples);
  for (std::size_t n = 0; n < samples; ++n) e->y_shown[n] = plant.passive[n];
  for (int m = 0; m < info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    PrepareMode(result.pack, result.effects, m, &execute_data);
    if (execute_data.num_samples == 0) continue;
    for (std::size_t d = 0; d < static_cast<std::size_t>(info.num_parameters); ++d)
      shown_theta.value[d].fill(shown[1].theta[i][d]);
    kernels.predict(model, execute_data, shown_theta, &band_prediction);
    for (std::size_t k = 0; k < static_cast<std::size_t>(execute_data.num_samples); ++k)
      e->y_shown[static_cast<std::size_t>(execute_data.sample[k])] =
          shown[1].known[i] && info.described->LawIsOutput(m) ? band_prediction.value[k][0] : kUnknown;
  }
  std::copy_n(e->y_shown.begin(), samples, e->y_shown_free_run.begin());
}

void Estimator::Impl::FillSimulated(ThetaTile* theta) const noexcept {
  for (int m = 0; m < info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    for (int d = 0; d < info.num_parameters; ++d) {
      std::array<double, kTileLanes>& row = theta->value[static_cast<std::size_t>(info.described->InPrediction(m, d))];
      if (last_estimates[i].known)
        row = band_theta[i].value[static_cast<std::size_t>(d)];
      else
        row.fill(samplers[i]->space().offset[static_cast<std::size_t>(d)]);
      if (shown[1].known[i]) row[0] = shown[1].theta[i][static_cast<std::size_t>(d)];
    }
  }
}

void Estimator::Impl::PredictSimulated(const DataPack& pack, Estimate* e) noexcept {
  const auto samples = static_cast<std::size_t>(pack.num_samples);
  const auto last = samples - 1;
  e->y_pred = e->y_lo = e->y_hi = e->y_free_run = kUnknown;
  const bool known = std::any_of(shown[1].known.begin(), shown[1].known.end(), [](bool k) { return k; });
  if (!known || !trajectory.Prepare(pack)) {
    trajectory.Reset();
    return;
  }
  FillSimulated(&shown_theta);
  trajectory.Run(shown_theta, &band_prediction);
  for (std::size_t n = 0; n < samples; ++n) {
    const double shown_now = band_prediction.value[n][0];
    if (std::isfinite(shown_now)) e->y_shown[n] = e->y_shown_free_run[n] = shown_now;
  }
  e->y_free_run = e->y_shown_free_run[last];
  SetBand(band_prediction.value[last], e);
  // With one diverging draw the mean does not exist.
  if (!std::isfinite(e->y_lo) || !std::isfinite(e->y_hi)) e->y_pred = e->y_lo = e->y_hi = kUnknown;
}

void Estimator::Impl::StoreBandDraws(int mode, const ModeDraws& draws) noexcept {
  const auto i = static_cast<std::size_t>(mode);
  for (int lane = 0; lane < kBandDraws; ++lane) {
    const int k = BandDraw(draws, lane);
    for (int d = 0; d < info.num_parameters; ++d)
      band_theta[i].value[static_cast<std::size_t>(d)][static_cast<std::size_t>(lane)] =
          samplers[i]->space().Theta(d, draws.u[static_cast<std::size_t>(d)][k]);
  }
}

void Estimator::Impl::PredictLastSample(const DataPack& pack, int mode, Estimate* e) noexcept {
  const auto i = static_cast<std::size_t>(mode);
  std::array<double, kBandDraws> outputs{};
  for (std::size_t lane = 0; lane < kBandDraws; ++lane) {
    if (simulates_output()) {
      std::array<double, kMaxParams> theta{};
      for (std::size_t d = 0; d < static_cast<std::size_t>(info.num_parameters); ++d)
        theta[d] = band_theta[i].value[d][lane];
      outputs[lane] = predictor->LastOutput(pack, shown[0], mode, theta.data());
    } else {
      outputs[lane] = band_prediction.value[static_cast<std::size_t>(execute_data.num_samples - 1)][lane];
    }
  }
  SetBand(outputs, e);
}

void Estimator::Impl::SetBand(const std::array<double, kTileLanes>& outputs, Estimate* e) noexcept {
  double mean = 0.0;
  double spread = 0.0;
  for (const double v : outputs) mean += v / kBandDraws;
  for (const double v : outputs) spread += (v - mean) * (v - mean) / (kBandDraws - 1);
  e->y_pred = mean;
  e->y_lo = mean - 1.96 * std::sqrt(spread);
  e->y_hi = mean + 1.96 * std::sqrt(spread);
}

void Estimator::Impl::WatchGap(const DataPack& pack, Estimate* e) noexcept {
  GapReference estimate;
  bool changed = false;
  bool drifts = false;
  for (int m = 0; m < info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    const ModeEstimate& mode = e->modes[i];
    estimate.known[i] = mode.known && mode.noise_std > 0.0;
    estimate.noise_std[i] = mode.noise_std;
    for (std::size_t d = 0; d < static_cast<std::size_t>(info.num_parameters); ++d)
      estimate.theta[i][d] = info.Sampled(
          static_cast<int>(d), mode.marginal[static_cast<std::size_t>(info.ReportedOf(static_cast<int>(d)))].ar_ap);
    drifts = drifts || (mode.updated && mode.p_drifted > 0.5);
    changed = changed || (mode.updated && (mode.decision == Decision::kModification || mode.p_changed > 0.5));
  }
  if (gap_watch) gap_watch->Step(pack, estimate, changed, drifts);
  if (output_watch) output_watch->Step(pack, shown[0]);
  e->gap = Gap();
}

const GapState& Estimator::Impl::Gap() const noexcept {
  const GapState& fitted = gap_watch ? gap_watch->state() : kNothingWatched;
  if (!output_watch) return fitted;
  const GapState& output = output_watch->state();
  if (fitted.suspected != output.suspected) return output.suspected ? output : fitted;
  if (fitted.num_blocks == 0 || output.num_blocks == 0) return output.num_blocks == 0 ? fitted : output;
  return output.log_evidence - output.log_threshold > fitted.log_evidence - fitted.log_threshold ? output : fitted;
}

const GapState& Estimator::gap() const noexcept { return impl_->Gap(); }

void Estimator::Execute(const AdjustResult& result, Estimate* e) noexcept {
  Impl& s = *impl_;
  const DataPack& pack = result.pack;
  e->seq = pack.seq;
  e->run_id = pack.run_id;
  e->t_last_ns = pack.t_last_ns;
  e->t_last_s = pack.t_last_s;
  e->num_reported = s.info.num_reported;
  e->num_modes = s.info.num_modes;
  e->num_samples = pack.num_samples;
  e->mode = pack.num_samples > 0 ? s.composition.ModeOf(pack, result.effects, pack.num_samples - 1) : s.info.num_modes;
  e->active = e->mode < s.info.num_modes;
  for (int m = 0; m < s.info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    const ModeDraws& draws = result.modes[i];
    ModeEstimate& last = s.last_estimates[i];
    last.updated = false;
    last.num_samples = draws.num_samples;
    if (draws.updated) {
      Summarise(s.info, s.settings.constants, s.samplers[i]->space(), draws, s.summary.get(), &last);
      if (draws.moves) MoveToEnd(s.info, s.settings.constants, s.samplers[i]->space(), draws, &last);
    } else {
      // Hold: the posterior is kept, apart from the effect of time (below); the numbers that describe one step are not.
      last.decision = Decision::kHold;
      last.zeta = 0.0;
      last.lambda = 1.0;
      last.draws = 0;
      last.k_min = 0;
      last.truncated = false;
      last.ess = last.kish_ess = last.acceptance = last.log_evidence = last.p_changed = 0.0;
    }
    e->modes[i] = last;
    if (!draws.updated && last.known && !s.samplers.empty())
      Widen(s.info, s.settings.constants, s.samplers[i]->space(), draws.widening, &e->modes[i]);
  }
  if (s.one_vector()) s.ShareVector(e);
  if (e->active && e->modes[static_cast<std::size_t>(e->mode)].known) s.report_mode = e->mode;
  e->report_mode = s.report_mode;
  if (result.status == Status::kBadPack) {
    e->y_pred = e->y_lo = e->y_hi = e->y_free_run = kUnknown;
    e->y_rmse = 0.0;
    e->gap = s.Gap();
    return;
  }
  s.WatchGap(pack, e);
  s.PredictOutput(result, e);
  s.shown[1] = s.shown[0];
  for (int m = 0; m < s.info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    const ModeEstimate& mode = e->modes[i];
    s.known_draws[i] = s.known_draws[i] || mode.updated;
    // Before its parameters are known, a force is predicted from their prior mean; the mode of a flat posterior is
    // arbitrary. (The flow of valves is not predicted then: their prior mean is zero flow.)
    const bool from_prior = s.predicts_from_prior();
    s.shown[0].known[i] = mode.known || (from_prior && s.known_draws[i]) || (from_prior && s.shown[1].known[i]);
    if (!mode.known && !(from_prior && s.known_draws[i])) continue;
    for (int d = 0; d < s.info.num_parameters; ++d) {
      const MarginalSummary& marginal = mode.marginal[static_cast<std::size_t>(s.info.ReportedOf(d))];
      s.shown[0].theta[i][static_cast<std::size_t>(d)] =
          s.info.Sampled(d, mode.known ? marginal.ar_map : marginal.ar_ap);
    }
  }
}

}  // namespace armcmc
