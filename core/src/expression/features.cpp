#include "armcmc/expression/features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "armcmc/expression/evaluate.hpp"

namespace armcmc::expression {
namespace {

double Lowpass(FeatureMemory::Slot* slot, double e, double tau, double dt, bool held) noexcept ARMCMC_NONBLOCKING {
  const double ratio = tau > 0.0 ? dt / tau : std::numeric_limits<double>::infinity();
  const double decay = std::exp(-ratio);
  // (1 - e^-r) / r, which is 1 at r = 0.
  const double mean = ratio > 0.0 ? -std::expm1(-ratio) / ratio : 1.0;
  slot->state = held ? slot->state * decay + slot->before * (1.0 - decay)
                     : slot->state * decay + slot->before * (mean - decay) + e * (1.0 - mean);
  slot->before = e;
  return slot->state;
}

/// The value `tau` before the newest of `samples`; not a number where the line does not reach back so far.
double Delayed(const std::array<double, kMaxDelaySamples>& line, int samples, double tau, double dt,
               bool held) noexcept ARMCMC_NONBLOCKING {
  const int kept = std::min(samples, kMaxDelaySamples);
  const double asked = tau / dt;
  if (asked > kept - 1 && samples >= kMaxDelaySamples) return std::numeric_limits<double>::quiet_NaN();
  constexpr double kRounding = 1e-6;  // tolerance for a computed whole number of samples
  const double whole_back = held ? std::ceil(asked - kRounding) : asked;
  const double back = std::clamp(whole_back, 0.0, static_cast<double>(kept - 1));
  const int whole = std::min(static_cast<int>(back), kept - 1);
  const double part = back - whole;
  const auto at = [&](int k) { return line[static_cast<std::size_t>((samples - 1 - k) % kMaxDelaySamples)]; };
  const double later = at(whole);
  return whole + 1 < kept ? later + part * (at(whole + 1) - later) : later;
}

}  // namespace

FeatureProgram::FeatureProgram(const Graph& graph, const std::vector<int>& outputs) {
  std::vector<bool> needed(static_cast<std::size_t>(graph.size()), false);
  for (const int output : outputs) needed[static_cast<std::size_t>(output)] = true;
  for (int n = graph.size() - 1; n >= 0; --n)
    if (needed[static_cast<std::size_t>(n)])
      for (const int argument : graph.at(n).argument)
        if (argument >= 0) needed[static_cast<std::size_t>(argument)] = true;

  std::vector<std::int16_t> place(static_cast<std::size_t>(graph.size()), -1);
  for (int n = 0; n < graph.size(); ++n) {
    if (!needed[static_cast<std::size_t>(n)]) continue;
    const GraphNode& node = graph.at(n);
    Instruction i;
    i.op = node.op;
    i.value = node.value;
    i.kind = node.kind;
    i.index = static_cast<std::int16_t>(node.index);
    for (std::size_t a = 0; a < kMaxArguments; ++a)
      i.argument[a] = node.argument[a] < 0 ? std::int16_t{-1} : place[static_cast<std::size_t>(node.argument[a])];
    i.held = InfoOf(node.op).memory && node.argument[2] >= 0;
    if (InfoOf(node.op).memory) i.index = static_cast<std::int16_t>(num_memories_++);
    if (node.op == Op::kDelay) i.line = static_cast<std::int16_t>(num_delays_++);
    place[static_cast<std::size_t>(n)] = static_cast<std::int16_t>(code_.size());
    code_.push_back(i);
  }
  const auto limit = [](int count, int most, const char* what) {
    if (count > most) throw std::length_error("needs more than " + std::to_string(most) + ' ' + what);
  };
  limit(size(), kMaxFeatureNodes, "operations a sample");
  limit(num_memories_, kMaxMemories, "functions with memory");
  limit(num_delays_, kMaxDelays, "delays");
  for (const int output : outputs) outputs_.push_back(place[static_cast<std::size_t>(output)]);
}

void FeatureProgram::Evaluate(const FeatureInput& input, FeatureMemory* memory,
                              double* out) const noexcept ARMCMC_NONBLOCKING {
  std::array<double, kMaxFeatureNodes> value;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before read
  const bool first = !has_memory() || memory->empty;
  const double dt = first ? 0.0 : input.dt;
  for (std::size_t n = 0; n < code_.size(); ++n) {
    const Instruction& i = code_[n];
    const auto argument = [&](std::size_t a) {
      return i.argument[a] < 0 ? 0.0 : value[static_cast<std::size_t>(i.argument[a])];
    };
    if (i.op == Op::kNumber) {
      value[n] = i.value;
      continue;
    }
    if (i.op == Op::kSymbol) {
      value[n] = i.kind == SymbolKind::kTime       ? input.t
                 : i.kind == SymbolKind::kInterval ? input.dt
                                                   : input.signals[i.index];
      continue;
    }
    if (!InfoOf(i.op).memory) {
      value[n] = expression::Evaluate(i.op, argument(0), argument(1), argument(2));
      continue;
    }
    FeatureMemory::Slot& slot = memory->slot[static_cast<std::size_t>(i.index)];
    const double e = argument(0);
    if (first) slot = {i.op == Op::kLowpass ? e : 0.0, e};
    switch (i.op) {
      case Op::kLowpass: value[n] = first ? e : Lowpass(&slot, e, argument(1), dt, i.held); break;
      case Op::kIntegral:
        slot.state += i.held ? dt * slot.before : 0.5 * dt * (slot.before + e);
        slot.before = e;
        value[n] = slot.state;
        break;
      case Op::kPrevious:
        value[n] = slot.before;
        slot.before = e;
        break;
      case Op::kElapsed:
        slot.state += dt;
        value[n] = slot.state;
        break;
      default: {  // delay
        auto& line = memory->line[static_cast<std::size_t>(i.line)];
        line[static_cast<std::size_t>(memory->samples % kMaxDelaySamples)] = e;
        value[n] = first ? e : Delayed(line, memory->samples + 1, argument(1), dt, i.held);
      }
    }
  }
  for (std::size_t o = 0; o < outputs_.size(); ++o) out[o] = value[static_cast<std::size_t>(outputs_[o])];
  if (!has_memory()) return;
  memory->empty = false;
  // Keeps counting without overflow and without changing the position in the line.
  memory->samples = memory->samples + 1 < 2 * kMaxDelaySamples ? memory->samples + 1 : kMaxDelaySamples;
}

}  // namespace armcmc::expression
