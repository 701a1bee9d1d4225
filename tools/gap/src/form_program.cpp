#include "form_program.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "armcmc/gap/features.hpp"

namespace armcmc::gap {
namespace {

using expression::SymbolKind;

constexpr double kFlat = 1e-9;  // slope times sample interval, below which a rate counts as constant

int StateSymbol(expression::Graph* graph, std::size_t k) {
  return graph->Symbol(SymbolKind::kState, kFirstState + static_cast<int>(k));
}

int MoveOf(const FormState& state) { return state.rate < 0 ? state.next : state.rate; }

/// Which states an output needs, itself or by others.
std::vector<bool> NeededBy(int output, const std::vector<FormState>& states, expression::Graph* graph) {
  if (states.size() > static_cast<std::size_t>(kMostFormStates)) throw std::invalid_argument("more than 8 states");
  std::vector<bool> needed(states.size());
  for (std::size_t k = states.size(); k-- > 0;) {
    const int z = StateSymbol(graph, k);
    needed[k] = graph->DependsOn(output, z);
    for (std::size_t later = k + 1; later < states.size(); ++later)
      needed[k] = needed[k] || (needed[later] && graph->DependsOn(MoveOf(states[later]), z));
  }
  return needed;
}

/// d rate / dz.
int SlopeOf(int rate, int z, expression::Graph* graph) {
  const int slope = graph->Differentiate(rate, z);
  if (slope < 0) throw std::invalid_argument("the rate of a state has no derivative");
  return slope;
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

/// Node of (exp(x) - 1) / x, exact near zero.
int MeanGrowth(int x, expression::Graph* graph) {
  using expression::Op;
  constexpr double kNear = 1e-2;  // (exp(x) - 1) / x has lost two of its sixteen digits there,
  constexpr int kTerms = 6;       // and the series is short by 1e-16
  const int one = graph->Number(1.0);
  int series = one;
  for (int n = kTerms; n >= 2; --n)
    series = graph->Make(Op::kAdd, one,
                         graph->Make(Op::kMultiply, graph->Make(Op::kMultiply, x, graph->Number(1.0 / n)), series));
  const int grown = graph->Make(Op::kSubtract, graph->Make(Op::kExp, x), one);
  return graph->Make(Op::kIf, graph->Make(Op::kLess, graph->Make(Op::kAbs, x), graph->Number(kNear)), series,
                     graph->Make(Op::kDivide, grown, x));
}

/// Node of a state one sample later.
int NextOf(const FormState& state, int z, expression::Graph* graph) {
  using expression::Op;
  if (state.rate < 0) return state.next;
  const int dt = graph->Symbol(SymbolKind::kInterval, 0);
  const int share = graph->Make(Op::kMultiply, SlopeOf(state.rate, z, graph), dt);
  const int moved = graph->Make(Op::kMultiply, graph->Make(Op::kMultiply, state.rate, dt), MeanGrowth(share, graph));
  return graph->Make(Op::kAdd, z, moved);
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

FormProgram::FormProgram(expression::Graph* graph, const std::vector<FormState>& states, int output)
    : states_(states.size()), output_(graph, {output}) {
  const std::vector<bool> needed = NeededBy(output, states, graph);
  for (std::size_t k = 0; k < states.size(); ++k) {
    State& state = states_[k];
    state.needed = needed[k];
    if (!state.needed) continue;
    state.start = RowProgram(graph, {states[k].start});
    state.jumps = states[k].rate < 0;
    if (state.jumps) {
      if (graph->at(states[k].next).memory) throw std::invalid_argument("a state that jumps has no other memory");
      state.move = RowProgram(graph, {states[k].next});
      continue;
    }
    const int z = StateSymbol(graph, k), slope = SlopeOf(states[k].rate, z, graph);
    if (graph->DependsOn(slope, z)) throw std::invalid_argument("a state's rate is not linear in it");
    state.move = RowProgram(graph, {slope, graph->Substitute(states[k].rate, {{z, graph->Number(0.0)}})});
  }
}

Vector FormProgram::Over(const Signals& s, const Vector* law, const std::vector<double>& values) const {
  RowInputs inputs;
  inputs.rows = s.rows();
  inputs.dt = s.dt;
  std::copy(values.begin(), values.end(), inputs.value.begin());
  const auto input = [&](FormSignal signal) -> const double*& { return inputs.series[static_cast<std::size_t>(signal)]; };
  for (std::size_t r = 0; r < kNumRoles; ++r) inputs.series[r] = s.input[r].data();
  input(FormSignal::kActive) = s.active.data();
  input(FormSignal::kTime) = s.t.data();
  if (law != nullptr) input(FormSignal::kLaw) = law->data();
  constexpr int kRetreating = static_cast<int>(FormSignal::kRetreating);
  const auto retreats = [](const State& state) { return state.start.Reads(kRetreating) || state.move.Reads(kRetreating); };
  Vector retreating;
  if (output_.Reads(kRetreating) || std::any_of(states_.begin(), states_.end(), retreats)) {
    retreating = retreat_->Of(s);
    input(FormSignal::kRetreating) = retreating.data();
  }
  std::vector<Vector> series(states_.size());
  for (std::size_t k = 0; k < states_.size(); ++k) {
    const State& state = states_[k];
    if (!state.needed) continue;
    const double start = state.start.AtFirst(inputs);
    if (state.jumps) {
      series[k] = state.move.Recursion(inputs, static_cast<int>(k), start);
    } else {
      const std::vector<Vector> rate = state.move.Over(inputs);
      series[k] = Linear(rate[0], rate[1], start, s.dt);
    }
    inputs.series[static_cast<std::size_t>(kFirstState) + k] = series[k].data();
  }
  return output_.Over(inputs)[0];
}

ForceProgram::ForceProgram(expression::Graph* graph, const std::vector<FormState>& states, int output) {
  const std::vector<bool> needed = NeededBy(output, states, graph);
  num_states_ = static_cast<std::size_t>(std::find(needed.rbegin(), needed.rend(), true).base() - needed.begin());
  std::vector<int> next;
  std::map<int, int> moved;  // a state sees those before it as they are one sample later
  for (std::size_t k = 0; k < num_states_; ++k) {
    const int z = StateSymbol(graph, k);
    next.push_back(graph->Substitute(NextOf(states[k], z, graph), moved));
    moved[z] = next.back();
  }
  for (std::size_t n = 0; n < next.size() + 1; ++n)
    if (const int node = n < next.size() ? next[n] : output; graph->at(node).memory)
      throw std::invalid_argument("functions with memory are not available here: use a state");
  using identify::Varies;
  std::vector<Varies> varies(static_cast<std::size_t>(kNumFormInputs), Varies::kByLane);
  std::fill_n(varies.begin(), kFirstPast, Varies::kByBoth);
  for (const FormSignal same : {FormSignal::kTime, FormSignal::kDrive})
    varies[static_cast<std::size_t>(same)] = Varies::kBySample;
  force_ = identify::LaneProgram(*graph, {output}, varies);
  moves_ = identify::LaneProgram(*graph, next, varies);
}

class ForceProgram::Run final : public MotionForce {
 public:
  Run(const ForceProgram& program, const std::vector<identify::Lanes>& values, double dt) : program_(&program) {
    std::vector<identify::Lanes> inputs(static_cast<std::size_t>(kNumFormInputs));
    std::copy(values.begin(), values.end(), inputs.begin() + kFirstValue);
    force_ = program.force_.Begin(inputs.data(), dt);
    moves_ = program.moves_.Begin(inputs.data(), dt);
  }

  void Move(Motions* motions) override {
    if (program_->num_states_ == 0) return;
    Recall(motions);
    program_->moves_.Evaluate(1, motions->input.data(), 1, &kNoTime, &moves_, states_.data());
  }

  void At(Motions* motions, identify::Lanes* acceleration) override {
    Recall(motions);
    program_->force_.Evaluate(1, motions->input.data(), 1, &kNoTime, &force_, acceleration);
  }

 private:
  static constexpr double kNoTime = 0.0;

  void Recall(Motions* motions) const {
    std::copy_n(states_.begin(), program_->num_states_, motions->input.begin() + kFirstState);
  }

  const ForceProgram* program_;
  std::array<identify::Lanes, kMostFormStates> states_{};
  identify::LaneRun force_, moves_;
};

std::unique_ptr<MotionForce> ForceProgram::Begin(const std::vector<identify::Lanes>& values, double dt) const {
  return std::make_unique<Run>(*this, values, dt);
}

}  // namespace armcmc::gap
