#include "armcmc/estimator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "armcmc/adjust_result.hpp"
#include "armcmc/baselines/pack_filter.hpp"
#include "armcmc/effects/composition.hpp"
#include "armcmc/gap_watch/gap_watch.hpp"
#include "armcmc/mode_sampler.hpp"
#include "armcmc/models/registry.hpp"
#include "armcmc/output_predictor.hpp"
#include "armcmc/snapshot.hpp"
#include "armcmc/summary.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr int kBandDraws = kTileLanes;  // draws behind the predicted output and its band, one tile

/// Two memories of a mode: one read while the other is written, so that a failed step leaves the posterior untouched.
struct ModeMemory {
  PosteriorMemory slot[2];
  int current = 0;
};

int ModelIndex(const EstimatorSettings& settings) {
  settings.Validate();
  return FindModel(settings.model);
}

}  // namespace

struct Estimator::Impl {
  explicit Impl(const EstimatorSettings& s)
      : settings(s),
        model(ModelIndex(s)),
        composition(s),
        info(composition.info()),
        kernels(simd::Best()),
        predictor(info, s.constants),
        summary(s.sampler.max_draws),
        gap_watch(settings, model, kernels) {
    dim = info.num_parameters;
    samplers.reserve(static_cast<std::size_t>(info.num_modes));
    for (int m = 0; m < info.num_modes; ++m) {
      const NoiseSettings& noise = settings.noise[static_cast<std::size_t>(m)];
      const ParameterSpace space(composition.sampled(), noise);
      dim = std::max(dim, space.dim);
      samplers.emplace_back(std::make_unique<ModeSampler>(kernels, model, settings.sampler, settings.forgetting, space,
                                                          NoiseModel(noise)));
      memories.emplace_back(std::make_unique<ModeMemory>());
      if (settings.method != Method::kArmcmc)
        filters.emplace_back(MakeFilter({kernels, model, settings, space, NoiseModel(noise)}));
    }
    workspace = std::make_unique<SamplerWorkspace>(dim, settings.sampler.max_draws);
    ShowPrior();
  }

  /// What is on display before the first pack: of a contact the prior's mean, of the valves nothing.
  void ShowPrior() noexcept {
    for (ShownEstimates& s : shown) {
      s = ShownEstimates{};
      if (info.plant != PlantKind::kHuntCrossley) continue;
      s.known[0] = true;
      for (int d = 0; d < info.num_parameters; ++d)
        s.theta[0][static_cast<std::size_t>(d)] = samplers[0]->space().offset[static_cast<std::size_t>(d)];
    }
  }

  void PrepareMode(const DataPack& pack, const EffectPack& effects, int mode, ModeData* data) const noexcept {
    if (composition.empty()) {
      AllModels::kPrepare[static_cast<std::size_t>(model)](pack, settings.constants, mode, data);
    } else {
      Composition::Fill(pack, effects, data);
    }
    data->pack_share = static_cast<double>(data->num_samples) / pack.num_samples;
    const double rho = settings.forgetting.rho;
    data->weighted = rho > 0.0;
    // Weights by the distance from the end of the pack, within the samples of the mode.
    for (int n = 0; n < data->num_samples; ++n)
      data->weight[static_cast<std::size_t>(n)] = rho > 0.0 ? std::exp(-rho * (data->num_samples - 1 - n)) : 1.0;
  }

  EstimatorSettings settings;
  int model;
  Composition composition;
  const ModelInfo& info;
  const simd::Kernels& kernels;
  int dim = 0;

  /// One step of mode m with the method of the settings.
  Status AdjustMode(std::size_t m, std::uint64_t pack, Nanos deadline_ns, ClockRef clock, int limit,
                    AdjustResult* result) noexcept ARMCMC_NONBLOCKING;
  /// A baseline with one vector of parameters shows it for every mode.
  void ShareVector(Estimate* e) noexcept ARMCMC_NONBLOCKING;
  [[nodiscard]] bool one_vector() const noexcept {
    return settings.method != Method::kArmcmc && !settings.baseline.recall && info.num_modes > 1;
  }

  // Adjust stage.
  std::vector<std::unique_ptr<PackFilter>> filters;  ///< Of a baseline, else empty.
  std::array<bool, kMaxModes> acted{};               ///< In the pack before.
  std::vector<std::unique_ptr<ModeSampler>> samplers;
  std::vector<std::unique_ptr<ModeMemory>> memories;
  std::unique_ptr<SamplerWorkspace> workspace;
  std::array<ModeData, kMaxModes> adjust_data;

  // Execute stage.
  OutputPredictor predictor;
  SummaryWorkspace summary;
  ModeData execute_data;
  std::array<ThetaTile, kMaxModes> band_theta;  ///< Thinned chain of the last update of each mode.
  PredictionTile band_prediction;
  ThetaTile shown_theta;
  std::array<ModeEstimate, kMaxModes> last_estimates;
  std::array<ShownEstimates, 2> shown;        ///< After the previous pack, and after the one before it.
  std::array<bool, kMaxModes> known_draws{};  ///< Some pack has updated the mode.
  int report_mode = 0;
  GapWatch gap_watch;

  void WatchGap(const DataPack& pack, Estimate* e) noexcept;
  /// Output at every sample of the pack with the estimates on display, for a model with effects.
  void PredictShown(const AdjustResult& result, Estimate* e) noexcept;
  void PredictOutput(const AdjustResult& result, Estimate* e) noexcept;
  void StoreBandDraws(int mode, const ModeDraws& draws) noexcept;
  /// Output at the last sample and its band; `band_prediction` holds the predictions of `mode`.
  void PredictLastSample(const DataPack& pack, int mode, Estimate* e) noexcept;
  [[nodiscard]] int BandDraw(const ModeDraws& draws, int lane) const noexcept {
    const int first = draws.burn_in;
    return draws.chain[first + static_cast<int>((static_cast<std::int64_t>(draws.draws - first) * lane) / kBandDraws)];
  }
};

Estimator::Estimator(const EstimatorSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
Estimator::~Estimator() = default;

std::unique_ptr<AdjustResult> Estimator::MakeResult() const {
  return std::make_unique<AdjustResult>(impl_->info.num_modes, impl_->dim, impl_->settings.sampler.max_draws);
}

Status Estimator::Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock, AdjustResult* result,
                         const DrawLimits& limits) noexcept {
  Impl& s = *impl_;
  for (int m = 0; m < s.info.num_modes; ++m) {
    ModeDraws& draws = result->modes[static_cast<std::size_t>(m)];
    draws.updated = false;
    const ModeMemory& memory = *s.memories[static_cast<std::size_t>(m)];
    draws.known = memory.slot[memory.current].valid && memory.slot[memory.current].informed;
    draws.num_samples = 0;
  }
  if (pack.Validate() != Status::kOk || pack.plant != s.info.plant || pack.num_inputs < s.info.num_inputs ||
      (!s.composition.empty() && !s.composition.Prepare(pack, &result->effects))) {
    result->status = Status::kBadPack;
    result->pack = DataPack{};
    result->pack.seq = pack.seq;
    result->pack.run_id = pack.run_id;
    return Status::kBadPack;
  }
  result->pack = pack;

  int pending = 0;
  std::array<bool, kMaxModes> active{};
  for (int m = 0; m < s.info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    s.PrepareMode(pack, result->effects, m, &s.adjust_data[i]);
    result->modes[i].num_samples = s.adjust_data[i].num_samples;
    active[i] = s.adjust_data[i].num_samples >= s.settings.forgetting.min_samples;
    pending += active[i] ? 1 : 0;
  }
  const int pending_modes = pending;
  Status status = Status::kHeld;
  for (int m = 0; m < s.info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    if (!active[i]) continue;
    // Modes that share a pack share the time that is left.
    const Nanos now = clock.Now();
    const Nanos mode_deadline =
        clock.read != nullptr ? now + (deadline_ns - now) / pending : std::numeric_limits<Nanos>::max() / 2;
    --pending;
    const Status mode_status =
        s.AdjustMode(i, static_cast<std::uint64_t>(pack.seq), mode_deadline, clock, limits[i], result);
    if (mode_status == Status::kNonFinite) {
      status = Status::kNonFinite;
      continue;
    }
    if (status == Status::kHeld || status == Status::kOk) status = mode_status;
  }
  for (std::size_t m = 0; m < kMaxModes; ++m)
    // Valves that are shut for a while change no mode; a lost contact does.
    if (pending_modes > 0 || s.info.num_modes == 1) s.acted[m] = active[m];
  result->status = status;
  return status;
}

Status Estimator::Impl::AdjustMode(std::size_t m, std::uint64_t pack, Nanos deadline_ns, ClockRef clock, int limit,
                                   AdjustResult* result) noexcept {
  ModeDraws* draws = &result->modes[m];
  if (!filters.empty()) {
    if (!acted[m]) filters[m]->Resume();
    return filters[m]->Run(adjust_data[m], pack, m, deadline_ns, clock, limit, draws);
  }
  ModeMemory& memory = *memories[m];
  const Status status = samplers[m]->Run(adjust_data[m], memory.slot[memory.current], pack, m, deadline_ns, clock,
                                         limit, workspace.get(), &memory.slot[1 - memory.current], draws);
  if (status != Status::kNonFinite) memory.current = 1 - memory.current;
  return status;
}

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
  if (composition.empty()) {
    predictor.Predict(pack, shown[1], &e->y_shown, &e->y_shown_free_run);
  } else {
    PredictShown(result, e);
  }
  const auto last = static_cast<std::size_t>(pack.num_samples - 1);
  e->y_free_run = e->y_shown_free_run[last];
  e->y_pred = e->y_lo = e->y_hi = 0.0;
  e->y_rmse = 0.0;

  // Fit of the posterior after the pack to the pack itself, over the modes that it knows; unit of the target.
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
    if (m == e->mode || !composition.empty()) PredictLastSample(pack, m, e);
  }
  e->y_rmse = count > 0 ? std::sqrt(square / count) : 0.0;
  if (info.plant == PlantKind::kSoftActuator && !e->active) e->y_pred = e->y_lo = e->y_hi = e->y_shown[last];
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
    if (info.plant == PlantKind::kSoftActuator) {
      std::array<double, kMaxParams> theta{};
      for (std::size_t d = 0; d < static_cast<std::size_t>(info.num_parameters); ++d)
        theta[d] = band_theta[i].value[d][lane];
      outputs[lane] = predictor.LastAngle(pack, shown[0], mode, theta.data());
    } else {
      outputs[lane] = band_prediction.value[static_cast<std::size_t>(execute_data.num_samples - 1)][lane];
    }
  }
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
  for (int m = 0; m < info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    const ModeEstimate& mode = e->modes[i];
    estimate.known[i] = mode.known && mode.noise_std > 0.0;
    estimate.noise_std[i] = mode.noise_std;
    for (std::size_t d = 0; d < static_cast<std::size_t>(info.num_parameters); ++d)
      estimate.theta[i][d] = mode.marginal[d].ar_ap;
    changed = changed || (mode.updated && (mode.decision == Decision::kModification || mode.p_changed > 0.5));
  }
  gap_watch.Step(pack, estimate, changed);
  e->gap = gap_watch.state();
}

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
  e->mode = pack.num_samples > 0 ? s.info.mode_of(pack, pack.num_samples - 1) : s.info.num_modes;
  e->active = e->mode < s.info.num_modes;
  for (int m = 0; m < s.info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    const ModeDraws& draws = result.modes[i];
    ModeEstimate& last = s.last_estimates[i];
    last.updated = false;
    last.num_samples = draws.num_samples;
    if (draws.updated) {
      Summarise(s.info, s.settings.constants, s.samplers[i]->space(), draws, &s.summary, &last);
    } else {
      // Held: the parameters stay, the numbers that describe one step do not.
      last.decision = Decision::kHold;
      last.zeta = 0.0;
      last.lambda = 1.0;
      last.draws = 0;
      last.k_min = 0;
      last.truncated = false;
      last.ess = last.kish_ess = last.acceptance = last.log_evidence = last.p_changed = 0.0;
    }
    e->modes[i] = last;
  }
  if (s.one_vector()) s.ShareVector(e);
  if (e->active && e->modes[static_cast<std::size_t>(e->mode)].known) s.report_mode = e->mode;
  e->report_mode = s.report_mode;
  if (result.status == Status::kBadPack) {
    e->y_pred = e->y_lo = e->y_hi = e->y_free_run = kUnknown;
    e->y_rmse = 0.0;
    e->gap = s.gap_watch.state();
    return;
  }
  s.WatchGap(pack, e);
  s.PredictOutput(result, e);
  s.shown[1] = s.shown[0];
  for (int m = 0; m < s.info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    const ModeEstimate& mode = e->modes[i];
    s.known_draws[i] = s.known_draws[i] || mode.updated;
    // A force can be predicted before its parameters are known: from their mean. The mode of a posterior that knows
    // nothing is an accident. (The valves' gains cannot: their prior mean is zero flow.)
    const bool contact = s.info.plant == PlantKind::kHuntCrossley;
    s.shown[0].known[i] = mode.known || (contact && s.known_draws[i]) || (contact && s.shown[1].known[i]);
    if (!mode.known && !(contact && s.known_draws[i])) continue;
    for (int d = 0; d < s.info.num_parameters; ++d) {
      const MarginalSummary& marginal = mode.marginal[static_cast<std::size_t>(d)];
      s.shown[0].theta[i][static_cast<std::size_t>(d)] = mode.known ? marginal.ar_map : marginal.ar_ap;
    }
  }
}

void Estimator::Reset() noexcept {
  Impl& s = *impl_;
  for (auto& filter : s.filters) filter->Reset();
  s.acted.fill(false);
  for (auto& memory : s.memories) memory->slot[0].valid = memory->slot[1].valid = false;
  for (auto& estimate : s.last_estimates) estimate = ModeEstimate{};
  s.ShowPrior();
  s.known_draws.fill(false);
  s.predictor.Reset();
  s.composition.Reset();
  s.gap_watch.Reset();
  s.report_mode = 0;
}

std::size_t Estimator::SaveAdjusted(std::span<std::byte> bytes) const noexcept {
  SnapshotWriter out(bytes);
  for (std::size_t m = 0; m < impl_->samplers.size(); ++m) {
    const ModeMemory& memory = *impl_->memories[m];
    memory.slot[memory.current].Save(&out);
    impl_->samplers[m]->transition().Save(&out);
  }
  return out.size();
}

std::size_t Estimator::SaveExecuted(std::span<std::byte> bytes) const noexcept {
  const Impl& s = *impl_;
  SnapshotWriter out(bytes);
  out.Put(std::int64_t{s.report_mode});
  for (std::size_t m = 0; m < static_cast<std::size_t>(s.info.num_modes); ++m) {
    out.PutFlag(s.known_draws[m]);
    s.last_estimates[m].Save(s.info.num_reported, &out);
    // The band is drawn with the first update, and read once something is known.
    for (std::size_t d = 0; s.last_estimates[m].known && d < static_cast<std::size_t>(s.info.num_parameters); ++d)
      out.PutRow(s.band_theta[m].value[d].data(), kTileLanes);
    for (const ShownEstimates& shown : s.shown) {
      out.PutFlag(shown.known[m]);
      out.PutRow(shown.theta[m].data(), static_cast<std::size_t>(s.info.num_parameters));
    }
  }
  s.gap_watch.Save(&out);
  return out.size();
}

bool Estimator::Restore(std::span<const std::byte> adjusted, std::span<const std::byte> executed) noexcept {
  Impl& s = *impl_;
  Reset();
  if (!s.filters.empty()) return false;  // a baseline keeps no snapshot
  SnapshotReader posterior(adjusted);
  for (std::size_t m = 0; m < s.memories.size(); ++m) {
    s.memories[m]->current = 0;
    s.memories[m]->slot[0].Restore(s.samplers[m]->space().dim, s.samplers[m]->shared_table(), &posterior);
    s.samplers[m]->transition().Restore(&posterior);
  }
  SnapshotReader display(executed);
  s.report_mode = static_cast<int>(display.Integer(0, s.info.num_modes - 1));
  for (std::size_t m = 0; m < s.memories.size(); ++m) {
    s.known_draws[m] = display.Flag();
    s.last_estimates[m].Restore(s.info.num_reported, &display);
    for (std::size_t d = 0; s.last_estimates[m].known && d < static_cast<std::size_t>(s.info.num_parameters); ++d)
      display.Row(s.band_theta[m].value[d].data(), kTileLanes);
    for (ShownEstimates& shown : s.shown) {
      shown.known[m] = display.Flag();
      display.Row(shown.theta[m].data(), static_cast<std::size_t>(s.info.num_parameters));
    }
  }
  s.gap_watch.Restore(&display);
  if (posterior.finished() && display.finished()) return true;
  Reset();
  return false;
}

const EstimatorSettings& Estimator::settings() const noexcept { return impl_->settings; }
PlantKind Estimator::plant() const noexcept { return impl_->info.plant; }
int Estimator::num_modes() const noexcept { return impl_->info.num_modes; }
std::string_view Estimator::mode_name(int mode) const noexcept {
  return impl_->info.modes[static_cast<std::size_t>(std::clamp(mode, 0, impl_->info.num_modes))];
}
int Estimator::num_reported() const noexcept { return impl_->info.num_reported; }
ReportedQuantity Estimator::reported(int index) const noexcept {
  const ReportedInfo& r = impl_->info.reported[static_cast<std::size_t>(index)];
  return {r.name, r.unit};
}
int Estimator::num_inputs() const noexcept { return impl_->info.num_inputs; }

}  // namespace armcmc
