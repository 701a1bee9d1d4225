#include "plants/soft_actuator/bend_predictor.hpp"

#include <cmath>
#include <type_traits>

#include "armcmc/scalar_ops.hpp"
#include "plants/soft_actuator/flow_law.hpp"
#include "plants/soft_actuator/model.hpp"

namespace armcmc {

BendPredictor::BendPredictor(const ModelInfo& info, const ActuatorConstants& constants, const FlowPlan& flow)
    : info_(info), constants_(constants), flow_(flow), motion_(constants) {}

bool BendPredictor::NextPressure(const Input& input, const ShownEstimates& shown, const State& state,
                                 double* p) const noexcept {
  const int mode = input.u_c != 0.0 ? 0 : (input.u_d != 0.0 ? 1 : 2);
  *p = state.p;
  if (mode == 2) return true;
  const auto m = static_cast<std::size_t>(mode);
  if (!shown.known[m]) return false;
  const double u = mode == 0 ? input.u_c : input.u_d;
  const auto rate = [&](double at) noexcept {
    const double gain = shown.theta[m][0] + shown.theta[m][1] * (at - constants_.p_atm);
    return gain != 0.0 ? u * SoftActuator::Head(at, mode, constants_) / gain : 0.0;
  };
  const double first = rate(state.p);
  *p = state.p + 0.5 * motion_.interval() * (first + rate(state.p + motion_.interval() * first));  // Heun
  return true;
}

double BendPredictor::Amplitude(std::size_t effect, double t_s, const double* theta) const noexcept {
  const FlowPlan::Term& term = flow_.term[effect];
  return term.there() && term.ActsAt(t_s) ? theta[static_cast<std::size_t>(term.parameter)] : 0.0;
}

double BendPredictor::TruePressure(double measured, double t_s, int mode, const ShownEstimates& shown) const noexcept {
  if (flow_.empty) return measured;
  auto m = static_cast<std::size_t>(mode);
  if (mode >= 2 || !shown.known[m]) m = shown.known[0] ? 0 : 1;
  if (!shown.known[m]) return measured;
  return measured - Amplitude(FlowEffects::kIndexOf<PressureBias>, t_s, shown.theta[m].data());
}

bool BendPredictor::NextPressureWithEffects(const Input& input, const ShownEstimates& shown, State* state,
                                            double* p) const noexcept {
  const double command = input.u_c != 0.0 ? input.u_c : -input.u_d;
  *p = state->p;
  const int valve = command != 0.0 ? (command > 0.0 ? 0 : 1) : state->valve;
  if (valve == 2) return true;  // nothing was ever opened
  const auto commanded = static_cast<std::size_t>(valve);
  if (!shown.known[commanded]) return false;
  double opening = command, spool = state->spool;
  if (flow_.lag().there()) {
    const ValveLag::Spool<ScalarOps> law(shown.theta[commanded][static_cast<std::size_t>(flow_.lag().parameter)],
                                         motion_.interval());
    spool = law.Next(spool, command);
    if (flow_.lag().ActsAt(input.t_s)) opening = spool;
  }
  const int mode = opening > 0.0 ? 0 : (opening < 0.0 ? 1 : valve);
  const auto m = static_cast<std::size_t>(mode);
  if (!shown.known[m]) return false;
  state->valve = valve;
  state->spool = spool;
  const double* theta = shown.theta[m].data();
  const auto rate = [&](double at) noexcept {
    FlowPoint<ScalarOps> point{opening, at - flow_.p_atm, flow_.supply, 0.0};
    FlowEffects::ForEach([&]<class E>(std::type_identity<E>, std::size_t e) noexcept {
      // The sensor's zero is not in the pressure that is simulated.
      if constexpr (FlowLaw<ScalarOps>::kActs<E> && !std::is_same_v<E, PressureBias>)
        E::template Apply<ScalarOps>(Amplitude(e, input.t_s, theta), &point);
    });
    const double gain = theta[0] + theta[1] * point.gauge;
    const double flow = FlowLaw<ScalarOps>::Opening(point, mode) * FlowLaw<ScalarOps>::Head(point, mode);
    return point.rate + (gain != 0.0 ? flow / gain : 0.0);
  };
  const double first = rate(state->p);
  *p = state->p + 0.5 * motion_.interval() * (first + rate(state->p + motion_.interval() * first));  // Heun
  return true;
}

bool BendPredictor::Advance(const Input& input, const ShownEstimates& shown, State* state) const noexcept {
  double next_p = state->p;
  if (!(flow_.empty ? NextPressure(input, shown, *state, &next_p)
                    : NextPressureWithEffects(input, shown, state, &next_p)))
    return false;
  Bend(std::isfinite(next_p) ? next_p : state->p, state);
  return true;
}

void BendPredictor::AdvanceOrHold(const Input& input, const ShownEstimates& shown, State* state) const noexcept {
  if (!Advance(input, shown, state)) Bend(state->p, state);
}

void BendPredictor::Bend(double next_p, State* state) const noexcept {
  state->bend = motion_.Next(state->bend, state->p, next_p);
  state->p = next_p;
}

void BendPredictor::Predict(const DataPack& pack, const ShownEstimates& shown,
                            std::array<double, kMaxPackSamples>* output,
                            std::array<double, kMaxPackSamples>* free_run) noexcept {
  motion_.SetInterval(pack.dt);
  const bool continues = pack.seq == last_seq_ + pack.seq_step && pack.run_id == last_run_;
  last_seq_ = pack.seq;
  last_run_ = pack.run_id;
  const double first_s = pack.t_last_s - (pack.num_samples - 1) * pack.dt;
  if (!continues) {
    restarted_ = {};
    restarted_.bend.angle = pack.y[0];
    restarted_.p = TruePressure(pack.u[0][2], first_s, restarted_.valve, shown);
    free_run_ = restarted_;
    backlog_size_ = 0;
  }
  restarted_.p = TruePressure(pack.u[0][2], first_s, restarted_.valve, shown);
  before_pack_ = restarted_;
  for (int n = 0; n < pack.num_samples; ++n) {
    const auto i = static_cast<std::size_t>(n);
    // The state is the prediction for this sample; the input of this sample carries it to the next one.
    (*output)[i] = restarted_.bend.angle;
    (*free_run)[i] = free_run_.bend.angle;
    const Input input{pack.u[i][0], pack.u[i][1], first_s + n * pack.dt};
    AdvanceOrHold(input, shown, &restarted_);
    if (backlog_size_ < static_cast<int>(backlog_.size())) backlog_[static_cast<std::size_t>(backlog_size_++)] = input;
    int used = 0;
    while (used < backlog_size_ && Advance(backlog_[static_cast<std::size_t>(used)], shown, &free_run_)) ++used;
    if (used > 0) {
      for (int k = used; k < backlog_size_; ++k)
        backlog_[static_cast<std::size_t>(k - used)] = backlog_[static_cast<std::size_t>(k)];
      backlog_size_ -= used;
    } else if (backlog_size_ == static_cast<int>(backlog_.size())) {
      backlog_size_ = 0;  // older than the promise of kBacklogPacks: go on from the measured pressure
      free_run_.p = TruePressure(pack.u[i][2], input.t_s, free_run_.valve, shown);
    }
  }
}

double BendPredictor::LastOutput(const DataPack& pack, const ShownEstimates& shown, int mode,
                                 const double* theta) const noexcept {
  ShownEstimates changed = shown;
  const auto m = static_cast<std::size_t>(mode);
  changed.known[m] = true;
  for (int d = 0; d < info_.num_parameters; ++d) changed.theta[m][static_cast<std::size_t>(d)] = theta[d];
  State state = before_pack_;
  for (int n = 0; n + 1 < pack.num_samples; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const Input input{pack.u[i][0], pack.u[i][1], pack.t_last_s - (pack.num_samples - 1 - n) * pack.dt};
    AdvanceOrHold(input, changed, &state);
  }
  return state.bend.angle;
}

}  // namespace armcmc
