#include "plants/soft_actuator/flow_rows.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "armcmc/scalar_ops.hpp"
#include "plants/soft_actuator/flow_law.hpp"
#include "plants/soft_actuator/model.hpp"

namespace armcmc {
namespace {

constexpr double kRemembered = 8.0;       // time constants after which a spool has forgotten its start
constexpr double kUnsure = 4.0;           // longest time constants after a start
constexpr double kLeastGainShare = 0.01;  // of the size of the gains in the prior
constexpr int kNone = SoftActuator::kInfo.num_modes;

std::size_t Index(int i) noexcept { return static_cast<std::size_t>(i); }

}  // namespace

FlowPlan::FlowPlan(const EstimatorSettings& settings, int first_amplitude)
    : empty(false),
      p_atm(ActuatorConstants(settings.constants).p_atm),
      supply(ActuatorConstants(settings.constants).p_supply - p_atm) {
  const ParameterSettings& gain = settings.parameters[0];
  const bool normal = gain.prior == PriorKind::kNormal;
  least_gain = kLeastGainShare * (normal ? std::max(std::fabs(gain.mean), gain.sd)
                                         : std::max(std::fabs(gain.lower), std::fabs(gain.upper)));
  for (int e = 0; e < settings.num_effects; ++e) {
    const EffectSettings& effect = settings.effects[Index(e)];
    const int index = FlowEffects::Find(effect.name);
    term[Index(index)] = {first_amplitude, effect.gate, effect.from_s, effect.until_s};
    const EffectInfo& info = *FlowEffects::kInfos[Index(index)];
    first_amplitude += info.num_amplitudes;
    head_moves = head_moves || effect.name == PressureBias::kInfo.name || effect.name == SupplyDroop::kInfo.name;
    if (effect.name == std::string_view(ValveLag::kInfo.name)) {
      const ParameterSettings& tau = effect.amplitudes[0];
      longest_lag = tau.upper;
      typical_lag =
          tau.prior == PriorKind::kNormal ? std::clamp(tau.mean, tau.lower, tau.upper) : 0.5 * (tau.lower + tau.upper);
    }
  }
}

FlowRows::FlowRows(const FlowPlan& plan) : plan_(plan) {}

void FlowRows::Recall(const DataPack& pack) noexcept {
  const bool continues = seq_ >= 0 && pack.seq == seq_ + pack.seq_step && pack.run_id == run_id_ && pack.dt == dt_;
  seq_ = pack.seq;
  run_id_ = pack.run_id;
  dt_ = pack.dt;
  history_ = 0;
  if (!plan_.lag().there()) return;
  if (!continues) {
    before_ = slowest_ = 0.0;
    unsure_ = static_cast<int>(std::fmin(std::ceil(kUnsure * plan_.longest_lag / pack.dt), kMaxFlowHistory));
    return;
  }
  const double wanted = std::fmin(std::ceil(kRemembered * plan_.longest_lag / pack.dt) + 1.0, kMaxFlowHistory);
  history_ = std::min(static_cast<int>(wanted), rows_);
  const int first = rows_ - history_;
  if (first > 0) before_ = spool_[Index(first - 1)];
  std::copy_n(command_.begin() + first, history_, command_.begin());
  std::copy_n(spool_.begin() + first, history_, spool_.begin());
}

std::unique_ptr<CompiledPack> FlowRows::MakePack() const { return std::make_unique<FlowPack>(); }

bool FlowRows::Prepare(const DataPack& pack, CompiledPack* compiled) noexcept {
  auto* out = static_cast<FlowPack*>(compiled);
  Recall(pack);
  const ValveLag::Spool<ScalarOps> typical(plan_.typical_lag, pack.dt), slowest(plan_.longest_lag, pack.dt);
  rows_ = history_;
  out->num_samples = pack.num_samples;
  out->dt = pack.dt;
  out->supply = plan_.supply;
  out->least_gain = plan_.least_gain;
  out->head_moves = plan_.head_moves;
  for (std::size_t e = 0; e < plan_.term.size(); ++e) out->amplitude[e] = plan_.term[e].parameter;
  for (int n = 0; n < pack.num_samples; ++n) {
    const auto& u = pack.u[Index(n)];
    const double t = pack.t_last_s - (pack.num_samples - 1 - n) * pack.dt;
    const int commanded = SoftActuator::ModeOf(pack, n);
    const double command = commanded == 0 ? u[0] : (commanded == 1 ? -u[1] : 0.0);
    out->gauge[Index(n)] = u[2] - plan_.p_atm;
    out->pdot[Index(n)] = u[3];
    out->head[Index(n)] = commanded < kNone
                              ? FlowLaw<ScalarOps>::Head({command, out->gauge[Index(n)], plan_.supply, 0.0}, commanded)
                              : 0.0;
    for (std::size_t e = 0; e < plan_.term.size(); ++e)
      out->gate[e][Index(n)] = plan_.term[e].there() && plan_.term[e].ActsAt(t) ? 1.0 : 0.0;
    bool sure = true;
    if (plan_.lag().there()) {
      spool_[Index(rows_)] = typical.Next(rows_ > 0 ? spool_[Index(rows_ - 1)] : before_, command);
      slowest_ = slowest.Next(slowest_, command);
      sure = !plan_.lag().ActsAt(t) || (unsure_ == 0 && slowest_ * command > 0.0);
      unsure_ = std::max(unsure_ - 1, 0);
    }
    command_[Index(rows_++)] = command;
    out->mode[Index(n)] = static_cast<std::int8_t>(sure ? commanded : kNone);
  }
  out->history = history_;
  out->spool = before_;
  std::copy_n(command_.begin(), rows_, out->command.begin());
  return true;
}

void FlowRows::Fill(const DataPack&, const CompiledPack& rows, int mode, ModeData* data) const noexcept {
  const auto& flow = static_cast<const FlowPack&>(rows);
  int m = 0;
  for (int n = 0; n < flow.num_samples; ++n) {
    if (flow.mode[Index(n)] != mode) continue;
    data->sample[Index(m)] = static_cast<std::int16_t>(n);
    data->target[Index(m++)] = flow.pdot[Index(n)];
  }
  data->num_samples = m;
  data->mode = mode;
  data->compiled = &flow;
}

}  // namespace armcmc
