// Set-up, and the adjust stage.

#include "armcmc/estimator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "armcmc/models/registry.hpp"
#include "estimator_impl.hpp"
#include "simd/kernels.hpp"

namespace armcmc {
namespace {

int ModelIndex(const EstimatorSettings& settings) {
  settings.Validate();
  return FindModel(settings.model);
}

/// Recursive least squares needs a law that is linear in its parameters: a plant's own law is, that of the rate is not.
EstimatorSettings Regressed(EstimatorSettings settings) {
  settings.regress_rate = settings.regress_rate && settings.method != Method::kRls;
  return settings;
}

/// False alarm rate of each watch: two watches share the configured rate.
double FalseAlarmRate(const EstimatorSettings& settings, const ModelInfo& info) {
  return settings.gap_watch.false_alarm_rate / (info.compiled != nullptr ? info.compiled->num_equations() : 1);
}

std::unique_ptr<OutputWatch> MakeOutputWatch(const EstimatorSettings& settings, const ModelInfo& info,
                                             const OutputPredictor* predictor) {
  if (info.compiled == nullptr || info.compiled->make_watch == nullptr) return nullptr;
  return info.compiled->make_watch(settings, FalseAlarmRate(settings, info), *predictor);
}

}  // namespace

Estimator::Impl::Impl(const EstimatorSettings& s, const Impl* lender)
    : settings(s),
      model(ModelIndex(s)),
      composition(Regressed(s)),
      info(composition.info()),
      kernels(simd::Best()),
      state_filter(info.described != nullptr ? &info.described->states() : nullptr),
      predictor(info.compiled != nullptr ? info.compiled->make_predictor(info, s.constants, composition.rows())
                                         : nullptr),
      trajectory(info.described != nullptr ? info.described->prediction() : nullptr, kernels),
      summary(lender != nullptr ? lender->summary : std::make_shared<SummaryWorkspace>(s.sampler.max_draws)),
      gap_watch(lender == nullptr || settings.gap_watch.enabled
                    ? std::make_unique<GapWatch>(settings, model, kernels, FalseAlarmRate(settings, info))
                    : nullptr),
      output_watch(MakeOutputWatch(settings, info, predictor.get())) {
  dim = info.num_parameters;
  drift_scratch = lender != nullptr ? lender->drift_scratch : Drift::MakeScratch();
  int num_linear = 0;
  samplers.reserve(static_cast<std::size_t>(info.num_modes));
  for (int m = 0; m < info.num_modes; ++m) {
    const NoiseSettings& noise = settings.noise[static_cast<std::size_t>(m)];
    const ParameterSpace space(composition.sampled(), noise);
    dim = std::max(dim, space.dim);
    samplers.emplace_back(std::make_unique<ModeSampler>(kernels, model, settings.sampler, settings.forgetting, space,
                                                        NoiseModel(noise), info.linear[static_cast<std::size_t>(m)],
                                                        drift_scratch));
    num_linear = std::max(num_linear, info.linear[static_cast<std::size_t>(m)].num_linear);
    memories.emplace_back(std::make_unique<ModeMemory>());
    if (settings.method != Method::kArmcmc)
      filters.emplace_back(MakeFilter({kernels, model, settings, space, NoiseModel(noise)}));
  }
  workspace = lender != nullptr ? lender->workspace
                                : std::make_shared<SamplerWorkspace>(dim, settings.sampler.max_draws, num_linear);
  ReportPrior();
  ForgetStates();
}

void Estimator::Impl::ForgetStates() noexcept {
  states_due = nullptr;
  const ParameterSpace& space = samplers[0]->space();
  for (std::size_t d = 0; d < static_cast<std::size_t>(info.num_parameters); ++d) {
    state_mean[d] = space.offset[d];
    state_sd[d] = space.scale[d];
  }
  state_noise = std::exp(space.log_noise_scale);
}

void Estimator::Impl::ReportPrior() noexcept {
  for (ShownEstimates& s : shown) {
    s = ShownEstimates{};
    if (!predicts_from_prior()) continue;
    for (std::size_t m = 0; m < samplers.size(); ++m) {
      s.known[m] = true;
      for (std::size_t d = 0; d < static_cast<std::size_t>(info.num_parameters); ++d)
        s.theta[m][d] = samplers[m]->space().offset[d];
    }
  }
}

void Estimator::Impl::PrepareMode(const DataPack& pack, const EffectPack& effects, int mode,
                                  ModeData* data) const noexcept {
  if (composition.empty()) {
    info.compiled->prepare(pack, settings.constants, mode, data);
  } else {
    composition.Fill(pack, effects, mode, data);
  }
  data->pack_share = static_cast<double>(data->num_samples) / pack.num_samples;
  data->time_s = pack.t_last_s;
  data->duration_s = pack.num_samples * pack.dt;
  data->interval_s = pack.dt;
  data->pack_samples = pack.num_samples;
  const double rho = settings.forgetting.rho;
  data->weighted = rho > 0.0;
  // Weights by the distance from the end of the pack, within the samples of the mode.
  for (int n = 0; n < data->num_samples; ++n)
    data->weight[static_cast<std::size_t>(n)] = rho > 0.0 ? std::exp(-rho * (data->num_samples - 1 - n)) : 1.0;
}

Estimator::Estimator(const EstimatorSettings& settings) : impl_(std::make_unique<Impl>(settings, nullptr)) {}
Estimator::Estimator(const EstimatorSettings& settings, const Estimator& lender)
    : impl_(std::make_unique<Impl>(settings, lender.impl_.get())) {}
Estimator::~Estimator() = default;

std::unique_ptr<AdjustResult> Estimator::MakeResult() const {
  auto result = std::make_unique<AdjustResult>(impl_->info.num_modes, impl_->dim, impl_->settings.sampler.max_draws);
  result->effects = impl_->composition.MakePack();
  return result;
}

Status Estimator::Adjust(const DataPack& pack, Nanos deadline_ns, ClockRef clock, AdjustResult* result,
                         const DrawLimits& limits) noexcept {
  const Status status = Draw(pack, deadline_ns, clock, result, limits);
  Remember(clock);
  return status;
}

Status Estimator::Draw(const DataPack& new_pack, Nanos deadline_ns, ClockRef clock, AdjustResult* result,
                       const DrawLimits& limits) noexcept {
  Impl& s = *impl_;
  s.Remember(clock);
  for (int m = 0; m < s.info.num_modes; ++m) {
    ModeDraws& draws = result->modes[static_cast<std::size_t>(m)];
    draws.updated = false;
    const ModeMemory& memory = *s.memories[static_cast<std::size_t>(m)];
    draws.known = memory.slot[memory.current].valid && memory.slot[memory.current].informed;
    draws.num_samples = 0;
    draws.widening = s.widening[static_cast<std::size_t>(m)];
  }
  const bool is_usable = new_pack.Validate() == Status::kOk && new_pack.plant == s.info.plant &&
                         s.IsOfThisPlant(new_pack) && new_pack.num_inputs >= s.info.num_inputs &&
                         new_pack.num_samples % s.settings.overlap == 0;
  if (is_usable) {
    result->pack = new_pack;
    result->pack.seq_step = s.settings.overlap;
  }
  const DataPack& pack = result->pack;
  if (!is_usable || (!s.composition.empty() && !s.composition.Prepare(pack, &result->effects))) {
    result->status = Status::kBadPack;
    result->pack = DataPack{};
    result->pack.seq = new_pack.seq;
    result->pack.run_id = new_pack.run_id;
    return Status::kBadPack;
  }

  std::array<ModeData, kMaxModes>& data = s.workspace->data;
  int pending = 0;
  std::array<bool, kMaxModes> active{};
  for (int m = 0; m < s.info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    s.PrepareMode(pack, result->effects, m, &data[i]);
    result->modes[i].num_samples = data[i].num_samples;
    active[i] = data[i].num_samples >= s.settings.forgetting.min_samples;
    if (!s.samplers.empty()) s.Wait(i, active[i]);
    result->modes[i].widening = s.widening[i];
    pending += active[i] ? 1 : 0;
  }
  s.ExpectStates(result);
  const int pending_modes = pending;
  Status status = Status::kHeld;
  for (int m = 0; m < s.info.num_modes; ++m) {
    const auto i = static_cast<std::size_t>(m);
    if (!active[i]) continue;
    // Modes in the same pack share the remaining time.
    const Nanos now = clock.Now();
    const Nanos mode_deadline = clock.read != nullptr ? now + (deadline_ns - now) / std::max(pending, 1)
                                                      : std::numeric_limits<Nanos>::max() / 2;
    --pending;
    const Status mode_status =
        s.DrawMode(i, static_cast<std::uint64_t>(pack.seq), mode_deadline, clock, limits[i], result);
    // The next mode needs the workspace, and the result contains whether anything is known.
    if (pending > 0 || !result->modes[i].known) s.Remember(clock);
    if (mode_status == Status::kNonFinite) {
      status = Status::kNonFinite;
      continue;
    }
    if (status == Status::kHeld || status == Status::kOk) status = mode_status;
  }
  for (std::size_t m = 0; m < kMaxModes; ++m)
    // Closed valves do not change the mode; a lost contact does.
    if (pending_modes > 0 || s.info.num_modes == 1) s.acted[m] = active[m];
  result->status = status;
  return status;
}

void Estimator::Remember(ClockRef clock) noexcept { impl_->Remember(clock); }

void Estimator::Prefetch() const noexcept {
  for (std::size_t m = 0; m < impl_->samplers.size(); ++m) {
    const ModeMemory& memory = *impl_->memories[m];
    memory.slot[memory.current].Prefetch();
    impl_->samplers[m]->drift().Prefetch();
  }
}

void Estimator::Impl::Wait(std::size_t m, bool acts) noexcept {
  const ModeMemory& memory = *memories[m];
  if (acts)
    widening[m].fill(1.0);
  else
    samplers[m]->drift().Widening(workspace->data[m].time_s, memory.slot[memory.current], &widening[m]);
}

Status Estimator::Impl::DrawMode(std::size_t m, std::uint64_t pack, Nanos deadline_ns, ClockRef clock, int limit,
                                 AdjustResult* result) noexcept {
  ModeDraws* draws = &result->modes[m];
  if (!filters.empty()) {
    if (!acted[m]) filters[m]->Resume();
    return filters[m]->Run(workspace->data[m], pack, m, deadline_ns, clock, limit, draws);
  }
  const ModeMemory& memory = *memories[m];
  const Status status = samplers[m]->Run(workspace->data[m], memory.slot[memory.current], pack, m, deadline_ns, clock,
                                         limit, workspace.get(), draws);
  if (status != Status::kNonFinite) {
    not_remembered = draws;
    not_remembered_mode = m;
  }
  return status;
}

void Estimator::Impl::Remember(ClockRef clock) noexcept {
  if (not_remembered != nullptr) {
    ModeMemory& memory = *memories[not_remembered_mode];
    memory.current = 1 - memory.current;
    samplers[not_remembered_mode]->Remember(clock, workspace.get(), &memory.slot[memory.current], not_remembered);
    not_remembered = nullptr;
  }
  CarryStates();
}

void Estimator::Impl::ExpectStates(AdjustResult* result) noexcept {
  if (state_filter.empty()) return;
  states_due = result;
  ModeData* data = workspace->data.data();
  state_filter.ForgetOpenStarts();
  state_filter.Predict(kernels, state_mean, state_noise, data);
  if (data->num_samples == 0) return;
  const ModeMemory& memory = *memories[0];
  // Far from the prior's mean a wrong start has a different effect, so it is fitted near the current parameters.
  constexpr int kRounds = 2, kRoundsWithout = 8;  // for a known start, and for an unknown one
  std::array<double, kMaxParams> mean = state_mean;
  const auto find = [&](int rounds) {
    for (int round = 0; round < rounds && !memory.slot[memory.current].valid; ++round) {
      const ParamVector u = samplers[0]->ModeFromPrior(*data, workspace.get());
      for (int d = 0; d < info.num_parameters; ++d)
        mean[static_cast<std::size_t>(d)] = samplers[0]->space().Theta(d, u[d]);
      state_filter.Predict(kernels, mean, state_noise, data);
    }
  };
  find(kRounds);
  const std::array<double, kMaxParams> fixed_mean = mean;
  const double fixed_squares = state_filter.OpenStart(kernels, mean, state_noise, *data);
  if (fixed_squares < 0.0) return;
  state_filter.Predict(kernels, mean, state_noise, data);
  find(kRoundsWithout);
  if (!state_filter.StartIsContradicted(kernels, mean, state_noise, *data, fixed_squares))
    state_filter.Predict(kernels, fixed_mean, state_noise, data);
}

void Estimator::Impl::CarryStates() noexcept {
  if (states_due == nullptr) return;
  const ModeDraws& draws = states_due->modes[0];  // states make the modes one
  const ParameterSpace& space = samplers[0]->space();
  if (draws.updated) {
    // Whole vectors by the kernels, then the remaining draws.
    const int whole = draws.draws / 8 * 8;
    std::array<double, 2 + kMaxParams> first{};
    std::array<double, kMaxParams> mean{};
    std::array<double, kMaxParams*(kMaxParams + 1) / 2> second{};
    kernels.first_moments(space.dim, draws.u.data(), draws.weight, whole, first.data());
    for (std::size_t d = 0; d < static_cast<std::size_t>(space.dim); ++d) {
      mean[d] = first[2 + d];
      for (int k = whole; k < draws.draws; ++k) mean[d] += draws.weight[k] * draws.u[d][k];
    }
    kernels.second_moments(space.dim, draws.u.data(), draws.weight, mean.data(), whole, second.data());
    for (int d = 0; d < space.dim; ++d) {
      const auto i = static_cast<std::size_t>(d);
      double square = second[i * (i + 3) / 2];
      for (int k = whole; k < draws.draws; ++k)
        square += draws.weight[k] * (draws.u[i][k] - mean[i]) * (draws.u[i][k] - mean[i]);
      if (d >= info.num_parameters) {
        state_noise = std::exp(space.Theta(d, mean[i]));
      } else {
        state_mean[i] = space.Theta(d, mean[i]);
        state_sd[i] = space.scale[i] * std::sqrt(square);
      }
    }
  }
  std::array<double, kMaxStates> end{};
  state_filter.Update(kernels, state_mean, state_sd, state_noise, workspace->data[0], &end);
  composition.CarryStates(end);
  states_due = nullptr;
}

void Estimator::Reset() noexcept {
  Impl& s = *impl_;
  for (auto& filter : s.filters) filter->Reset();
  s.acted.fill(false);
  s.not_remembered = nullptr;
  for (auto& memory : s.memories) memory->slot[0].valid = memory->slot[1].valid = false;
  for (auto& sampler : s.samplers) sampler->drift().Forget();
  for (auto& estimate : s.last_estimates) estimate = ModeEstimate{};
  s.ReportPrior();
  s.known_draws.fill(false);
  if (s.predictor) s.predictor->Reset();
  s.trajectory.Reset();
  s.composition.Reset();
  s.ForgetStates();
  if (s.gap_watch) s.gap_watch->Reset();
  if (s.output_watch) s.output_watch->Reset();
  s.report_mode = 0;
}

const EstimatorSettings& Estimator::settings() const noexcept { return impl_->settings; }
std::string_view Estimator::target_unit() const noexcept { return impl_->info.target_unit; }
PlantNumber Estimator::plant() const noexcept { return impl_->info.plant; }
int Estimator::num_modes() const noexcept { return impl_->info.num_modes; }
std::string_view Estimator::mode_name(int mode) const noexcept {
  return impl_->info.modes[static_cast<std::size_t>(std::clamp(mode, 0, impl_->info.num_modes))];
}

int Estimator::num_reported() const noexcept { return impl_->info.num_reported; }
ReportedQuantity Estimator::reported(int index) const noexcept {
  const ReportedInfo& r = impl_->info.reported[static_cast<std::size_t>(index)];
  return {r.name, r.unit};
}

bool Estimator::watches_gap() const noexcept { return impl_->gap_watch && impl_->gap_watch->enabled(); }

std::string_view Estimator::gap_check_name(int check) const noexcept {
  const std::string_view fitted = impl_->gap_watch ? impl_->gap_watch->CheckName(check) : "";
  return fitted.empty() && impl_->output_watch ? impl_->output_watch->CheckName(check) : fitted;
}

int Estimator::num_inputs() const noexcept { return impl_->info.num_inputs; }

}  // namespace armcmc
