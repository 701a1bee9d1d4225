#include "form_program.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "armcmc/gap/features.hpp"

namespace armcmc::gap {
namespace {

using expression::SymbolKind;

constexpr double kFlat = 1e-9;  // slope times sample interval, below which a rate counts as constant

FormCode::Sample SampleOf(const Motion& motion, const double* values, const double* memory) {
  // By FormSignal, then t and dt.
  return {
      {motion.angle, motion.rate, 0, 0, 0, 0, 0, 0, motion.drive, motion.base, motion.t, motion.dt}, values, memory};
}

/// What code reads at row i of a recording.
void ReadRow(const Signals& signals, const Vector* law, Eigen::Index i, FormCode::Sample* sample) {
  for (std::size_t r = 0; r < kNumRoles; ++r)
    if (signals.input[r].size() > 0) sample->signal[r] = signals.input[r][i];
  sample->signal[static_cast<std::size_t>(FormSignal::kActive)] = signals.active[i];
  if (law != nullptr) sample->signal[static_cast<std::size_t>(FormSignal::kLaw)] = (*law)[i];
  sample->signal[kNumFormSignals] = signals.t[i];
  sample->signal[kNumFormSignals + 1] = signals.dt;
}

/// z' = slope z + rest with both held over a sample.
Vector Linear(const Vector& slope, const Vector& rest, double start, double dt) {
  const bool even = (slope.array() == slope[0]).all();
  const Vector keep = even ? Vector() : Exp(dt * slope);
  const double same = std::exp(dt * slope[0]);
  Vector z(slope.size());
  z[0] = start;
  for (Eigen::Index i = 1; i < z.size(); ++i) {
    if (std::abs(slope[i] * dt) < kFlat) {
      z[i] = z[i - 1] + (rest[i] + slope[i] * z[i - 1]) * dt;
    } else {
      const double end = -rest[i] / slope[i];
      z[i] = end + (z[i - 1] - end) * (even ? same : keep[i]);
    }
  }
  return z;
}

}  // namespace

Vector FormProgram::Retreat::Of(const Signals& s) {
  const double spread = std::max(s.smoothed_velocity_noise, 1e-9 * s.scale_of(Role::kVelocity));
  const Vector& velocity = s.at(Role::kVelocity);
  const std::lock_guard lock(mutex_);
  if (spread == spread_ && velocity.size() == velocity_.size() && velocity == velocity_) return last_;
  spread_ = spread;
  velocity_ = velocity;
  last_ = velocity.unaryExpr([spread](double v) { return 0.5 * std::erfc(v / (std::sqrt(2.0) * spread)); });
  return last_;
}

FormProgram::FormProgram(expression::Graph* graph, const std::vector<FormState>& states,
                         const std::vector<int>& outputs)
    : states_(states.size()), outputs_(*graph, outputs) {
  if (states.size() > kMostStates) throw std::invalid_argument("more than 8 states");
  const auto symbol = [&](std::size_t k) { return graph->Symbol(SymbolKind::kState, static_cast<int>(k)); };
  const int retreating = graph->Symbol(SymbolKind::kSignal, static_cast<int>(FormSignal::kRetreating));
  for (std::size_t k = states.size(); k-- > 0;) {
    const int z = symbol(k);
    State& state = states_[k];
    state.needed = std::any_of(outputs.begin(), outputs.end(), [&](int n) { return graph->DependsOn(n, z); });
    for (std::size_t later = k + 1; later < states.size(); ++later)
      state.needed =
          state.needed || (states_[later].needed &&
                           graph->DependsOn(states[later].rate < 0 ? states[later].next : states[later].rate, z));
    state.start = FormCode(*graph, {states[k].start});
    if (graph->DependsOn(states[k].rate < 0 ? states[k].next : states[k].rate, retreating) ||
        graph->DependsOn(states[k].start, retreating))
      throw std::invalid_argument("a state cannot read \"retreating\"");
    state.jumps = states[k].rate < 0;
    if (state.jumps) {
      state.rate = FormCode(*graph, {states[k].next});
      continue;
    }
    const int slope = graph->Differentiate(states[k].rate, z);
    if (slope < 0) throw std::invalid_argument("the rate of a state has no derivative");
    state.linear = !graph->DependsOn(slope, z);
    state.rate = FormCode(*graph, {states[k].rate, slope});
    state.rest = FormCode(*graph, {slope, graph->Substitute(states[k].rate, {{z, graph->Number(0.0)}})});
  }
  reads_retreat_ = outputs_.Reads(FormSignal::kRetreating);
}

bool FormProgram::has_states() const {
  return std::any_of(states_.begin(), states_.end(), [](const State& state) { return state.needed; });
}

bool FormProgram::is_linear() const {
  return std::all_of(states_.begin(), states_.end(), [](const State& s) { return !s.needed || s.linear; });
}

std::vector<Vector> FormProgram::Over(const Signals& signals, const Vector* law, const double* values) const {
  const Vector retreating = reads_retreat_ ? retreat_->Of(signals) : Vector();
  std::vector<Vector> states(states_.size());
  const FormCode::Recording recording{signals, &retreating, law, values, states};
  for (std::size_t k = 0; k < states_.size(); ++k) {
    const State& state = states_[k];
    if (!state.needed) continue;
    std::array<double, kMostStates> now{};
    for (std::size_t earlier = 0; earlier < k; ++earlier)
      if (states_[earlier].needed) now[earlier] = states[earlier][0];
    FormCode::Sample sample{{}, values, now.data()};
    ReadRow(signals, law, 0, &sample);
    double start = 0.0;
    state.start.AtSample(sample, &start);
    if (!state.jumps) {
      const std::vector<Vector> rate = state.rest.OverRecording(recording);
      states[k] = Linear(rate[0], rate[1], start, signals.dt);
      continue;
    }
    Vector z(signals.rows());
    z[0] = now[k] = start;
    for (Eigen::Index i = 1; i < z.size(); ++i) {
      ReadRow(signals, law, i, &sample);
      for (std::size_t earlier = 0; earlier < k; ++earlier)
        if (states_[earlier].needed) now[earlier] = states[earlier][i];
      state.rate.AtSample(sample, &now[k]);
      z[i] = now[k];
    }
    states[k] = z;
  }
  return outputs_.OverRecording(recording);
}

double FormProgram::At(const Motion& motion, const double* values, const double* memory) const {
  double force = 0.0;
  outputs_.AtSample(SampleOf(motion, values, memory), &force);
  return force;
}

void FormProgram::Remember(const Motion& motion, const double* values, double* memory) const {
  for (std::size_t k = 0; k < states_.size(); ++k) {
    std::array<double, 2> rate{};
    states_[k].rate.AtSample(SampleOf(motion, values, memory), rate.data());
    const double share = rate[1] * motion.dt;
    if (states_[k].jumps)
      memory[k] = rate[0];
    else
      memory[k] += std::abs(share) < kFlat ? rate[0] * motion.dt : rate[0] * std::expm1(share) / rate[1];
  }
}

}  // namespace armcmc::gap
