#include "armcmc/identify/lane_program.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "armcmc/expression/elementary.hpp"
#include "armcmc/expression/evaluate.hpp"
#include "armcmc/support/wider_lanes.hpp"

namespace armcmc::identify {
namespace {

using expression::Op;

constexpr double kMostMultiplied = 16.0;  // exponents below it

ARMCMC_INSIDE double OrNan(double value, double of) { return of == of ? value : of; }
ARMCMC_INSIDE double Least(double a, double b) { return OrNan(OrNan(a < b ? a : b, a), b); }
ARMCMC_INSIDE double Greatest(double a, double b) { return OrNan(OrNan(a > b ? a : b, a), b); }

/// Written out where expression::Evaluate would not become vector instructions.
template <Op op>
ARMCMC_INSIDE void ForAll(std::size_t count, const double* __restrict a, const double* __restrict b,
                          const double* __restrict c, double* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) {
    if constexpr (op == Op::kAdd)
      out[i] = a[i] + b[i];
    else if constexpr (op == Op::kSubtract)
      out[i] = a[i] - b[i];
    else if constexpr (op == Op::kMultiply)
      out[i] = a[i] * b[i];
    else if constexpr (op == Op::kDivide)
      out[i] = a[i] / b[i];
    else if constexpr (op == Op::kNegate)
      out[i] = -a[i];
    else if constexpr (op == Op::kAbs)
      out[i] = std::fabs(a[i]);
    else if constexpr (op == Op::kSqrt)
      out[i] = std::sqrt(a[i]);
    else if constexpr (op == Op::kLess)
      out[i] = a[i] < b[i] ? 1.0 : 0.0;
    else if constexpr (op == Op::kLessEqual)
      out[i] = a[i] <= b[i] ? 1.0 : 0.0;
    else if constexpr (op == Op::kSign)
      out[i] = a[i] > 0.0 ? 1.0 : a[i] < 0.0 ? -1.0 : a[i];
    else if constexpr (op == Op::kMin)
      out[i] = Least(a[i], b[i]);
    else if constexpr (op == Op::kMax)
      out[i] = Greatest(a[i], b[i]);
    else if constexpr (op == Op::kClamp)
      out[i] = Least(Greatest(a[i], b[i]), c[i]);
    else if constexpr (op == Op::kStep)
      out[i] = OrNan(a[i] >= 0.0 ? 1.0 : 0.0, a[i]);
    else
      out[i] = a[i] != 0.0 ? b[i] : c[i];
  }
}

/// By whole vectors: what is written in parts is waited for where it is read as a whole.
ARMCMC_INSIDE void Copy(const double* from, double* to) { std::memcpy(to, from, sizeof(Lanes)); }

/// a^(whole + 0.5 if half), by as few multiplications as there are bits.
/// @param square  Room; memory, since what stands in registers by parts is waited for when it is read as a whole.
ARMCMC_INSIDE void PowerOfAll(std::size_t count, const double* __restrict a, int whole, bool half,
                              double* __restrict square, double* __restrict out) {
  ARMCMC_OVER_LANES
  for (std::size_t i = 0; i < count; ++i) out[i] = half ? std::sqrt(a[i]) : 1.0;
  ARMCMC_OVER_LANES
  for (std::size_t i = 0; i < count; ++i) square[i] = a[i];
  for (int bits = whole; bits > 0; bits >>= 1) {
    if ((bits & 1) != 0) {
      ARMCMC_OVER_LANES
      for (std::size_t i = 0; i < count; ++i) out[i] *= square[i];
    }
    ARMCMC_OVER_LANES
    for (std::size_t i = 0; i < count; ++i) square[i] *= square[i];
  }
}

ARMCMC_INSIDE void Apply(Op op, std::size_t count, const double* a, const double* b, const double* c, double* out) {
  switch (op) {
    case Op::kAdd: return ForAll<Op::kAdd>(count, a, b, c, out);
    case Op::kSubtract: return ForAll<Op::kSubtract>(count, a, b, c, out);
    case Op::kMultiply: return ForAll<Op::kMultiply>(count, a, b, c, out);
    case Op::kDivide: return ForAll<Op::kDivide>(count, a, b, c, out);
    case Op::kNegate: return ForAll<Op::kNegate>(count, a, b, c, out);
    case Op::kLess: return ForAll<Op::kLess>(count, a, b, c, out);
    case Op::kLessEqual: return ForAll<Op::kLessEqual>(count, a, b, c, out);
    case Op::kAbs: return ForAll<Op::kAbs>(count, a, b, c, out);
    case Op::kSign: return ForAll<Op::kSign>(count, a, b, c, out);
    case Op::kSqrt: return ForAll<Op::kSqrt>(count, a, b, c, out);
    case Op::kMin: return ForAll<Op::kMin>(count, a, b, c, out);
    case Op::kMax: return ForAll<Op::kMax>(count, a, b, c, out);
    case Op::kClamp: return ForAll<Op::kClamp>(count, a, b, c, out);
    case Op::kStep: return ForAll<Op::kStep>(count, a, b, c, out);
    case Op::kIf: return ForAll<Op::kIf>(count, a, b, c, out);
    default:
      if (op != Op::kPower && expression::Elementary(op, count, a, nullptr, out)) return;
      for (std::size_t i = 0; i < count; ++i) out[i] = expression::Evaluate(op, a[i], b[i], c[i]);
  }
}

static_assert(kLanes % expression::kElementaryStride == 0);

/// What is left of the state after a sample, and the weight of the argument at the sample before.
void LowpassWeights(double tau, double dt, double* decay, double* weight) {
  const double ratio = tau > 0.0 ? dt / tau : std::numeric_limits<double>::infinity();
  *decay = std::exp(-ratio);
  // (1 - e^-r) / r, which is 1 where nothing decays.
  *weight = ratio > 0.0 ? -std::expm1(-ratio) / ratio : 1.0;
}

/// The value `tau` before the newest, linear between samples; before the first sample, the first.
/// @param held  Not linear, but the last sample before.
double Delayed(const std::vector<Lanes>& line, std::size_t lane, double tau, double dt, bool held) {
  constexpr double kRounding = 1e-6;  // a whole number of samples that was computed is one
  const auto newest = static_cast<double>(line.size() - 1);
  const double asked = held ? std::ceil(tau / dt - kRounding) : tau / dt;
  if (std::isnan(asked)) return asked;
  const double at = newest - std::clamp(asked, 0.0, newest);
  const auto whole = static_cast<std::size_t>(at);
  const double part = at - static_cast<double>(whole);
  const double earlier = line[whole][lane];
  return part > 0.0 ? earlier + part * (line[whole + 1][lane] - earlier) : earlier;
}

Varies Both(Varies a, Varies b) { return a == b ? a : Varies::kByBoth; }

}  // namespace

void LaneRun::Clear() {
  empty = true;
  for (std::vector<Lanes>& l : line) l.clear();
}

LaneProgram::LaneProgram(const expression::Graph& graph, const std::vector<int>& outputs,
                         const std::vector<Varies>& inputs)
    : input_size_(inputs.size()) {
  std::vector<bool> needed(static_cast<std::size_t>(graph.size()), false);
  for (const int output : outputs) needed[static_cast<std::size_t>(output)] = true;
  for (int n = graph.size() - 1; n >= 0; --n)
    if (needed[static_cast<std::size_t>(n)])
      for (const int argument : graph.at(n).argument)
        if (argument >= 0) needed[static_cast<std::size_t>(argument)] = true;

  struct Place {
    std::size_t block = 0;
    Varies varies = Varies::kByLane;
    bool constant = false;  ///< Varies neither way.
  };
  std::vector<Place> place(static_cast<std::size_t>(graph.size()));
  for (int n = 0; n < graph.size(); ++n) {
    if (!needed[static_cast<std::size_t>(n)]) continue;
    const expression::GraphNode& node = graph.at(n);
    Instruction i;
    i.op = node.op;
    i.value = node.value;
    i.time = node.kind == expression::SymbolKind::kTime;
    i.interval = i.op == Op::kSymbol && node.kind == expression::SymbolKind::kInterval;
    i.block = num_blocks_++;
    bool constant = i.op != Op::kSymbol, first = true;
    for (std::size_t a = 0; a < expression::kMaxArguments; ++a) {
      if (node.argument[a] < 0) continue;
      const Place& argument = place[static_cast<std::size_t>(node.argument[a])];
      i.argument[a] = argument.block;
      if (argument.constant) continue;
      constant = false;
      i.varies = first ? argument.varies : Both(i.varies, argument.varies);
      first = false;
    }
    const bool power = i.op == Op::kPower, constant_power = power && graph.at(node.argument[1]).op == Op::kNumber;
    i.root = power && !constant_power;
    if (constant_power) {
      const double exponent = graph.at(node.argument[1]).value;
      i.root = exponent != std::floor(exponent);
      i.half = exponent - std::floor(exponent) == 0.5;
      if (exponent > 0.0 && exponent < kMostMultiplied && (i.half || exponent == std::floor(exponent)))
        i.power = static_cast<int>(exponent);
    }
    if (i.op == Op::kSymbol && !i.interval) {
      i.index = static_cast<std::size_t>(node.index);
      i.varies = i.time ? Varies::kBySample : inputs[i.index];
    }
    i.memory = expression::InfoOf(i.op).memory;
    if (i.memory) {
      i.held = node.argument[2] >= 0;
      i.steady = i.op == Op::kLowpass && place[static_cast<std::size_t>(node.argument[1])].varies == Varies::kByLane;
      i.index = num_memories_++;
      i.varies = Varies::kByBoth;
      constant = false;
    }
    if (i.op == Op::kDelay) i.line = num_delays_++;
    place[static_cast<std::size_t>(n)] = {i.block, i.varies, constant};
    (i.varies == Varies::kByLane ? once_ : each_).push_back(i);
  }
  for (const int output : outputs) outputs_.push_back(place[static_cast<std::size_t>(output)].block);
  GuardBranches();
}

void LaneProgram::GuardBranches() {
  constexpr std::size_t kUnused = SIZE_MAX;
  std::vector<Guard> guard(num_blocks_, Guard{kUnused, false});
  const auto use = [&](std::size_t block, Guard where) {
    Guard& its = guard[block];
    if (its.condition == kUnused) its = where;
    if (its.condition != where.condition || its.holds != where.holds) its = {};
  };
  std::vector<bool> by_sample(num_blocks_, false);
  std::vector<std::size_t> place(num_blocks_, 0);
  for (std::size_t k = 0; k < each_.size(); ++k) {
    by_sample[each_[k].block] = each_[k].varies == Varies::kBySample;
    place[each_[k].block] = k;
  }
  for (const std::size_t output : outputs_) use(output, {});
  for (std::size_t k = each_.size(); k-- > 0;) {
    Instruction& i = each_[k];
    const bool chooses = i.op == Op::kIf && by_sample[i.argument[0]];
    i.guard = i.memory ? Guard{} : guard[i.block];
    // A condition that is computed later still has the value of the sample before.
    if (i.guard.condition > 0 && place[i.guard.condition] > k) i.guard = {};
    for (std::size_t a = 0; a < i.argument.size(); ++a)
      use(i.argument[a], chooses && a > 0 ? Guard{i.argument[0], a == 1} : i.guard);
  }
}

bool LaneProgram::Reads(std::size_t signal) const {
  return std::any_of(each_.begin(), each_.end(),
                     [signal](const Instruction& i) { return i.op == Op::kSymbol && !i.time && i.index == signal; });
}

LaneRun LaneProgram::Begin(const Lanes* input, double dt) const {
  LaneRun run;
  run.dt = dt;
  run.one.resize(num_blocks_ + 1);
  run.tile.resize(num_blocks_ + 1);
  run.slot.resize(num_memories_);
  run.line.resize(num_delays_);
  for (const Instruction& i : once_) {
    if (i.op == Op::kNumber || i.interval)
      run.one[i.block].value.fill(i.interval ? dt : i.value);
    else if (i.op == Op::kSymbol)
      Copy(input[i.index].data(), run.one[i.block].value.data());
  }
  ComputeOnce(&run.one);
  for (const Instruction& i : once_)
    for (std::size_t r = 0; r < kTile; ++r)
      Copy(run.one[i.block].value.data(), run.tile[i.block].value.data() + r * kLanes);
  for (const Instruction& i : each_) {
    if (!i.steady) continue;
    LaneRun::Slot& slot = run.slot[i.index];
    for (std::size_t l = 0; l < kLanes; ++l)
      LowpassWeights(run.one[i.argument[1]].value[l], dt, &slot.decay[l], &slot.weight[l]);
  }
  return run;
}

LaneRun LaneProgram::BeginPair(const Lanes* input, double dt) const {
  LaneRun run;
  run.dt = dt;
  run.pair.resize(num_blocks_ + 1);
  std::vector<Lanes> half(input_size_);
  for (std::size_t h = 0; h < 2; ++h) {
    for (std::size_t i = 0; i < half.size(); ++i) half[i] = input[2 * i + h];
    const LaneRun alone = Begin(half.data(), dt);
    for (const Instruction& i : once_)
      Copy(alone.one[i.block].value.data(), run.pair[i.block].value.data() + h * kLanes);
  }
  return run;
}

/// With `kSamples` known where this is compiled, an instruction is a few vectors and no loop.
template <std::size_t kSamples>
ARMCMC_INSIDE void LaneProgram::Compute(const Instruction& i, Blocks<kSamples>* blocks) {
  const double* const a = (*blocks)[i.argument[0]].value.data();
  const double* const b = (*blocks)[i.argument[1]].value.data();
  const double* const c = (*blocks)[i.argument[2]].value.data();
  double* const out = (*blocks)[i.block].value.data();
  if (i.varies != Varies::kBySample && i.power >= 0)
    return PowerOfAll(kSamples * kLanes, a, i.power, i.half, blocks->back().value.data(), out);
  if (i.varies != Varies::kBySample && i.root)
    return static_cast<void>(expression::Elementary(i.op, kSamples * kLanes, a, b, out));
  if (i.varies != Varies::kBySample) return Apply(i.op, kSamples * kLanes, a, b, c, out);
  for (std::size_t r = 0; r < kSamples * kLanes; r += kLanes)
    std::fill_n(out + r, kLanes, expression::Evaluate(i.op, a[r], b[r], c[r]));
}

template <std::size_t kSamples>
ARMCMC_INSIDE void LaneProgram::Walk(const Lanes* input, std::size_t stride, const double* t, LaneRun* run,
                                     Blocks<kSamples>* blocks, Lanes* out) const {
  for (const Instruction& i : each_) {
    if constexpr (kSamples < kTile)  // all candidates of one sample take the same branch
      if (i.guard.condition > 0 && ((*blocks)[i.guard.condition].value[0] != 0.0) != i.guard.holds) continue;
    double* const value = (*blocks)[i.block].value.data();
    if (i.op == Op::kSymbol && i.time)
      for (std::size_t r = 0; r < kSamples; ++r) std::fill_n(value + r * kLanes, kLanes, t[r]);
    else if (i.op == Op::kSymbol)
      for (std::size_t r = 0; r < kSamples; ++r) Copy(input[i.index * stride + r].data(), value + r * kLanes);
    else if (i.memory)
      for (std::size_t r = 0; r < kSamples; ++r)
        Remember(i, run->empty && r == 0, (*blocks)[i.argument[0]].value.data() + r * kLanes,
                 (*blocks)[i.argument[1]].value.data() + r * kLanes, run, value + r * kLanes);
    else
      Compute<kSamples>(i, blocks);
  }
  for (std::size_t o = 0; o < outputs_.size(); ++o)
    for (std::size_t r = 0; r < kSamples; ++r)
      Copy((*blocks)[outputs_[o]].value.data() + r * kLanes, out[o * stride + r].data());
}

ARMCMC_FOR_WIDER_LANES
void LaneProgram::WalkOne(const Lanes* input, std::size_t stride, const double* t, LaneRun* run, Lanes* out) const {
  Walk<1>(input, stride, t, run, &run->one, out);
}

ARMCMC_FOR_WIDER_LANES
void LaneProgram::WalkPair(const Lanes* input, const double* t, LaneRun* run, Lanes* out) const {
  Walk<2>(input, 2, t, run, &run->pair, out);
}

ARMCMC_FOR_WIDER_LANES
void LaneProgram::WalkTile(const Lanes* input, std::size_t stride, const double* t, LaneRun* run, Lanes* out) const {
  Walk<kTile>(input, stride, t, run, &run->tile, out);
}

ARMCMC_FOR_WIDER_LANES
void LaneProgram::ComputeOnce(Blocks<1>* blocks) const {
  for (const Instruction& i : once_)
    if (i.op != Op::kNumber && i.op != Op::kSymbol) Compute<1>(i, blocks);
}

void LaneProgram::Evaluate(std::size_t samples, const Lanes* input, std::size_t stride, const double* t, LaneRun* run,
                           Lanes* out) const {
  if (samples == kTile) {
    WalkTile(input, stride, t, run, out);
    run->empty = false;
    return;
  }
  for (std::size_t r = 0; r < samples; ++r) {
    WalkOne(input + r, stride, t + r, run, out + r);
    run->empty = false;
  }
}

void LaneProgram::EvaluatePair(const Lanes* input, double t, LaneRun* run, Lanes* out) const {
  const std::array<double, 2> same{t, t};
  WalkPair(input, same.data(), run, out);
}

ARMCMC_FOR_WIDER_LANES
void LaneProgram::Remember(const Instruction& instruction, bool first, const double* e, const double* tau, LaneRun* run,
                           double* y) {
  LaneRun::Slot& slot = run->slot[instruction.index];
  const double dt = run->dt;
  if (first) {
    std::copy_n(e, kLanes, slot.before.data());
    slot.state = instruction.op == Op::kLowpass ? slot.before : Lanes{};
  }
  switch (instruction.op) {
    case Op::kLowpass:
      if (!instruction.steady)
        for (std::size_t l = 0; l < kLanes; ++l) LowpassWeights(tau[l], dt, &slot.decay[l], &slot.weight[l]);
      for (std::size_t l = 0; l < kLanes && !first; ++l)
        slot.state[l] = slot.state[l] * slot.decay[l] +
                        slot.before[l] * ((instruction.held ? 1.0 : slot.weight[l]) - slot.decay[l]) +
                        (instruction.held ? 0.0 : e[l] * (1.0 - slot.weight[l]));
      std::copy_n(slot.state.data(), kLanes, y);
      break;
    case Op::kIntegral:
      for (std::size_t l = 0; l < kLanes; ++l)
        y[l] = slot.state[l] += first ? 0.0 : dt * (instruction.held ? slot.before[l] : 0.5 * (slot.before[l] + e[l]));
      break;
    case Op::kPrevious: std::copy_n(slot.before.data(), kLanes, y); break;
    case Op::kElapsed:
      for (std::size_t l = 0; l < kLanes; ++l) y[l] = slot.state[l] += first ? 0.0 : dt;
      break;
    default: {
      std::vector<Lanes>& line = run->line[instruction.line];
      line.emplace_back();
      std::copy_n(e, kLanes, line.back().data());
      for (std::size_t l = 0; l < kLanes; ++l) y[l] = Delayed(line, l, tau[l], dt, instruction.held);
    }
  }
  std::copy_n(e, kLanes, slot.before.data());
}

}  // namespace armcmc::identify
