#include "armcmc/identify/lane_program.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "armcmc/expression/evaluate.hpp"

// One more version of what follows for processors with wider vectors, the same to the bit: no operation is fused. Not
// under sanitizers, which have to start before such a choice is made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define ARMCMC_FOR_WIDER_LANES __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define ARMCMC_FOR_WIDER_LANES
#endif

namespace armcmc::identify {
namespace {

using expression::Op;

/// out = f(a, b) lane by lane.
template <class Function>
void ForLanes(const Lanes& a, const Lanes& b, Lanes* out, Function f) {
  for (std::size_t l = 0; l < kLanes; ++l) (*out)[l] = f(a[l], b[l]);
}

/// Operations that the compiler makes vector instructions of; false: none of these.
bool Vectorised(Op op, const Lanes& a, const Lanes& b, const Lanes& c, Lanes* out) {
  switch (op) {
    case Op::kAdd: ForLanes(a, b, out, [](double x, double y) { return x + y; }); return true;
    case Op::kSubtract: ForLanes(a, b, out, [](double x, double y) { return x - y; }); return true;
    case Op::kMultiply: ForLanes(a, b, out, [](double x, double y) { return x * y; }); return true;
    case Op::kDivide: ForLanes(a, b, out, [](double x, double y) { return x / y; }); return true;
    case Op::kNegate: ForLanes(a, b, out, [](double x, double) { return -x; }); return true;
    case Op::kAbs: ForLanes(a, b, out, [](double x, double) { return std::fabs(x); }); return true;
    case Op::kSqrt: ForLanes(a, b, out, [](double x, double) { return std::sqrt(x); }); return true;
    case Op::kIf:
      for (std::size_t l = 0; l < kLanes; ++l) (*out)[l] = a[l] != 0.0 ? b[l] : c[l];
      return true;
    default: return false;
  }
}

Lanes All(double value) {
  Lanes lanes;
  lanes.fill(value);
  return lanes;
}

double Lowpass(double state, double before, double e, double tau, double dt) {
  const double ratio = tau > 0.0 ? dt / tau : std::numeric_limits<double>::infinity();
  const double decay = std::exp(-ratio);
  // (1 - e^-r) / r, which is 1 where nothing decays.
  const double mean = ratio > 0.0 ? -std::expm1(-ratio) / ratio : 1.0;
  return state * decay + before * (mean - decay) + e * (1.0 - mean);
}

/// The value `tau` before the newest, linear between samples; before the first sample, the first.
double Delayed(const std::vector<Lanes>& line, std::size_t lane, double tau, double dt) {
  const auto newest = static_cast<double>(line.size() - 1);
  const double asked = tau / dt;
  if (std::isnan(asked)) return asked;
  const double at = newest - std::clamp(asked, 0.0, newest);
  const auto whole = static_cast<std::size_t>(at);
  const double part = at - static_cast<double>(whole);
  const double earlier = line[whole][lane];
  return part > 0.0 ? earlier + part * (line[whole + 1][lane] - earlier) : earlier;
}

}  // namespace

void LaneMemory::Clear() {
  empty = true;
  for (std::vector<Lanes>& l : line) l.clear();
}

LaneProgram::LaneProgram(const expression::Graph& graph, const std::vector<int>& outputs,
                         const std::vector<std::uint8_t>& shared) {
  std::vector<bool> needed(static_cast<std::size_t>(graph.size()), false);
  for (const int output : outputs) needed[static_cast<std::size_t>(output)] = true;
  for (int n = graph.size() - 1; n >= 0; --n)
    if (needed[static_cast<std::size_t>(n)])
      for (const int argument : graph.at(n).argument)
        if (argument >= 0) needed[static_cast<std::size_t>(argument)] = true;

  std::vector<int> place(static_cast<std::size_t>(graph.size()), -1);
  for (int n = 0; n < graph.size(); ++n) {
    if (!needed[static_cast<std::size_t>(n)]) continue;
    const expression::GraphNode& node = graph.at(n);
    Instruction i;
    i.op = node.op;
    i.value = node.value;
    i.time = node.kind == expression::SymbolKind::kTime;
    i.index = node.index;
    i.shared = true;
    for (std::size_t a = 0; a < expression::kMaxArguments; ++a) {
      i.argument[a] = node.argument[a] < 0 ? -1 : place[static_cast<std::size_t>(node.argument[a])];
      if (i.argument[a] >= 0) i.shared = i.shared && code_[static_cast<std::size_t>(i.argument[a])].shared;
    }
    if (i.op == Op::kSymbol && !i.time) i.shared = shared[static_cast<std::size_t>(i.index)] != 0;
    if (expression::InfoOf(i.op).memory) {
      i.index = num_memories_++;
      i.shared = false;
    }
    if (i.op == Op::kDelay) i.line = num_delays_++;
    place[static_cast<std::size_t>(n)] = static_cast<int>(code_.size());
    code_.push_back(i);
  }
  for (const int output : outputs) outputs_.push_back(place[static_cast<std::size_t>(output)]);
}

LaneMemory LaneProgram::Memory() const {
  LaneMemory memory;
  memory.slot.resize(static_cast<std::size_t>(num_memories_));
  memory.line.resize(static_cast<std::size_t>(num_delays_));
  return memory;
}

ARMCMC_FOR_WIDER_LANES
void LaneProgram::Evaluate(const Lanes* input, double t, double dt, LaneMemory* memory, Lanes* out) const {
  static const Lanes zero{};
  static thread_local std::vector<Lanes> value;
  if (value.size() < code_.size()) value.resize(code_.size());
  for (std::size_t n = 0; n < code_.size(); ++n) {
    const Instruction& i = code_[n];
    const auto argument = [&](std::size_t a) -> const Lanes& {
      return i.argument[a] < 0 ? zero : value[static_cast<std::size_t>(i.argument[a])];
    };
    const Lanes &a = argument(0), &b = argument(1), &c = argument(2);
    if (i.op == Op::kNumber)
      value[n] = All(i.value);
    else if (i.op == Op::kSymbol)
      value[n] = i.time ? All(t) : input[i.index];
    else if (expression::InfoOf(i.op).memory)
      Remember(i, a, b, dt, memory, &value[n]);
    else if (i.shared)
      value[n] = All(expression::Evaluate(i.op, a[0], b[0], c[0]));
    else if (!Vectorised(i.op, a, b, c, &value[n]))
      for (std::size_t l = 0; l < kLanes; ++l) value[n][l] = expression::Evaluate(i.op, a[l], b[l], c[l]);
  }
  for (std::size_t o = 0; o < outputs_.size(); ++o) out[o] = value[static_cast<std::size_t>(outputs_[o])];
  if (memory != nullptr) memory->empty = false;
}

void LaneProgram::Remember(const Instruction& instruction, const Lanes& e, const Lanes& tau, double dt,
                           LaneMemory* memory, Lanes* out) const {
  LaneMemory::Slot& slot = memory->slot[static_cast<std::size_t>(instruction.index)];
  const bool first = memory->empty;
  if (first) slot = {instruction.op == Op::kLowpass ? e : Lanes{}, e};
  if (instruction.op == Op::kDelay) memory->line[static_cast<std::size_t>(instruction.line)].push_back(e);
  for (std::size_t l = 0; l < kLanes; ++l) {
    double& state = slot.state[l];
    double& y = (*out)[l];
    switch (instruction.op) {
      case Op::kLowpass: y = state = first ? e[l] : Lowpass(state, slot.before[l], e[l], tau[l], dt); break;
      case Op::kIntegral: y = state += first ? 0.0 : 0.5 * dt * (slot.before[l] + e[l]); break;
      case Op::kPrevious: y = slot.before[l]; break;
      case Op::kElapsed: y = state += first ? 0.0 : dt; break;
      default: y = Delayed(memory->line[static_cast<std::size_t>(instruction.line)], l, tau[l], dt);
    }
  }
  slot.before = e;
}

}  // namespace armcmc::identify
