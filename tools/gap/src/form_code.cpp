#include "form_code.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "armcmc/expression/elementary.hpp"
#include "armcmc/expression/evaluate.hpp"

namespace armcmc::gap {
namespace {

using expression::Op;
using expression::SymbolKind;

constexpr double kMostWhole = 8.0;
constexpr Eigen::Index kBlock = 512;  // rows at a time, so that what is between lies in the cache
static_assert(kBlock % expression::kElementaryStride == 0);

double WholePower(double base, int exponent) {
  double power = base;
  for (int i = 1; i < exponent; ++i) power *= base;
  return power;
}

inline double Value(Op op, int whole, double a, double b, double c) {
  switch (op) {
    case Op::kAdd: return a + b;
    case Op::kSubtract: return a - b;
    case Op::kMultiply: return a * b;
    case Op::kDivide: return a / b;
    case Op::kNegate: return -a;
    case Op::kAbs: return std::abs(a);
    case Op::kTanh: return std::tanh(a);
    default: return whole > 0 ? WholePower(a, whole) : expression::Evaluate(op, a, b, c);
  }
}

bool IsElementary(Op op) { return op == Op::kExp || op == Op::kTanh || op == Op::kSin || op == Op::kCos; }

/// A number, or one of every row of a block.
struct Operand {
  const double* data;
  Eigen::Index stride;
  double operator[](Eigen::Index i) const { return data[i * stride]; }
};

template <class F>
void Fill(Eigen::Index rows, double* out, const F& f) {
  for (Eigen::Index i = 0; i < rows; ++i) out[i] = f(i);
}

void OfEach(Op op, int whole, Eigen::Index rows, const std::array<Operand, expression::kMaxArguments>& x, double* out) {
  const Operand a = x[0], b = x[1], c = x[2];
  switch (op) {
    case Op::kAdd: return Fill(rows, out, [&](Eigen::Index i) { return a[i] + b[i]; });
    case Op::kSubtract: return Fill(rows, out, [&](Eigen::Index i) { return a[i] - b[i]; });
    case Op::kMultiply: return Fill(rows, out, [&](Eigen::Index i) { return a[i] * b[i]; });
    case Op::kDivide: return Fill(rows, out, [&](Eigen::Index i) { return a[i] / b[i]; });
    case Op::kNegate: return Fill(rows, out, [&](Eigen::Index i) { return -a[i]; });
    case Op::kAbs: return Fill(rows, out, [&](Eigen::Index i) { return std::abs(a[i]); });
    case Op::kSqrt: return Fill(rows, out, [&](Eigen::Index i) { return std::sqrt(a[i]); });
    case Op::kSign: return Fill(rows, out, [&](Eigen::Index i) { return a[i] > 0.0 ? 1.0 : a[i] < 0.0 ? -1.0 : a[i]; });
    case Op::kLess: return Fill(rows, out, [&](Eigen::Index i) { return a[i] < b[i] ? 1.0 : 0.0; });
    case Op::kLessEqual: return Fill(rows, out, [&](Eigen::Index i) { return a[i] <= b[i] ? 1.0 : 0.0; });
    // Of what is not a number: that.
    case Op::kMin: return Fill(rows, out, [&](Eigen::Index i) { return a[i] < b[i] || a[i] != a[i] ? a[i] : b[i]; });
    case Op::kMax: return Fill(rows, out, [&](Eigen::Index i) { return a[i] > b[i] || a[i] != a[i] ? a[i] : b[i]; });
    case Op::kClamp:
      return Fill(rows, out, [&](Eigen::Index i) {
        const double at_least = a[i] > b[i] || a[i] != a[i] ? a[i] : b[i];
        return at_least < c[i] || at_least != at_least ? at_least : c[i];
      });
    case Op::kIf: return Fill(rows, out, [&](Eigen::Index i) { return a[i] != 0.0 ? b[i] : c[i]; });
    case Op::kPower:
      if (whole == 2) return Fill(rows, out, [&](Eigen::Index i) { return a[i] * a[i]; });
      [[fallthrough]];
    default: return Fill(rows, out, [&](Eigen::Index i) { return Value(op, whole, a[i], b[i], c[i]); });
  }
}

/// `series` a time of `samples` earlier, linear between samples; before the first sample its value there.
void Delay(const double* series, double samples, Eigen::Index first, Eigen::Index rows, double* out) {
  const auto whole = static_cast<Eigen::Index>(std::max(samples, 0.0));
  const double part = std::max(samples, 0.0) - static_cast<double>(whole);
  Fill(rows, out, [&](Eigen::Index i) {
    const Eigen::Index near = first + i - whole;
    return (1.0 - part) * series[std::max<Eigen::Index>(near, 0)] + part * series[std::max<Eigen::Index>(near - 1, 0)];
  });
}

}  // namespace

FormCode::FormCode(const expression::Graph& graph, const std::vector<int>& outputs) {
  std::vector<bool> needed(static_cast<std::size_t>(graph.size()), false);
  for (const int output : outputs) needed[static_cast<std::size_t>(output)] = true;
  for (int n = graph.size() - 1; n >= 0; --n)
    for (const int argument : graph.at(n).argument)
      if (needed[static_cast<std::size_t>(n)] && argument >= 0) needed[static_cast<std::size_t>(argument)] = true;
  std::vector<int> place(needed.size(), 0);
  for (const bool loads : {true, false})
    for (int n = 0; n < graph.size(); ++n) {
      const expression::GraphNode& node = graph.at(n);
      if (!needed[static_cast<std::size_t>(n)] || (node.op == Op::kNumber || node.op == Op::kSymbol) != loads) continue;
      place[static_cast<std::size_t>(n)] = static_cast<int>(num_registers());
      if (loads) {
        loads_.push_back(LoadOf(node));
        continue;
      }
      const bool delays = node.op == Op::kDelay && graph.at(node.argument[0]).kind == SymbolKind::kSignal &&
                          graph.at(node.argument[0]).op == Op::kSymbol && !graph.at(node.argument[1]).varies;
      if (expression::InfoOf(node.op).memory && node.op != Op::kPrevious && !delays)
        throw std::invalid_argument(std::string(expression::InfoOf(node.op).name) +
                                    " is not available here: use a state");
      Operation operation{node.op, {0, 0, 0}, 0};
      for (std::size_t i = 0; i < node.argument.size(); ++i)
        if (node.argument[i] >= 0) operation.argument[i] = place[static_cast<std::size_t>(node.argument[i])];
      if (node.op == Op::kPower && graph.IsNumber(node.argument[1])) {
        const double exponent = graph.at(node.argument[1]).value;
        if (exponent == std::floor(exponent) && exponent >= 2.0 && exponent <= kMostWhole)
          operation.whole = static_cast<int>(exponent);
      }
      operations_.push_back(operation);
    }
  if (num_registers() > kMostRegisters)
    throw std::invalid_argument("more than " + std::to_string(kMostRegisters) + " names, numbers and operations");
  for (const int output : outputs) outputs_.push_back(place[static_cast<std::size_t>(output)]);
}

FormCode::Load FormCode::LoadOf(const expression::GraphNode& node) {
  if (node.op == Op::kNumber) {
    numbers_.push_back(node.value);
    return {From::kNumbers, static_cast<int>(numbers_.size()) - 1};
  }
  switch (node.kind) {
    case SymbolKind::kParameter: return {From::kValues, node.index};
    case SymbolKind::kState: return {From::kStates, node.index};
    case SymbolKind::kSignal: return {From::kSignals, node.index};
    case SymbolKind::kTime: return {From::kSignals, kTimeIndex};
    default: return {From::kSignals, kIntervalIndex};
  }
}

bool FormCode::Reads(FormSignal signal) const {
  return std::any_of(loads_.begin(), loads_.end(), [&](const Load& load) {
    return load.from == From::kSignals && load.index == static_cast<int>(signal);
  });
}

void FormCode::AtSample(const Sample& sample, double* outputs) const {
  std::array<double, kMostRegisters> result;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before read
  const std::array<const double*, 4> from{sample.signal.data(), sample.values, sample.states, numbers_.data()};
  std::size_t n = 0;
  for (const Load& load : loads_) result[n++] = from[static_cast<std::size_t>(load.from)][load.index];
  for (const Operation& of : operations_) {
    const auto at = [&](std::size_t i) { return result[static_cast<std::size_t>(of.argument[i])]; };
    result[n++] = Value(of.op, of.whole, at(0), at(1), at(2));
  }
  for (std::size_t i = 0; i < outputs_.size(); ++i) outputs[i] = result[static_cast<std::size_t>(outputs_[i])];
}

std::vector<Vector> FormCode::OverRecording(const Recording& recording) const {
  const Signals& s = recording.signals;
  const Eigen::Index rows = s.rows();
  const std::size_t registers = num_registers();
  std::vector<const double*> whole(registers, nullptr);  // of all rows
  std::vector<double> number(registers, 0.0), last(registers, 0.0);
  std::vector<bool> varies(registers, false);
  for (std::size_t n = 0; n < loads_.size(); ++n) {
    const Load& load = loads_[n];
    const Vector* series = nullptr;
    if (load.from == From::kNumbers)
      number[n] = numbers_[static_cast<std::size_t>(load.index)];
    else if (load.from == From::kValues)
      number[n] = recording.values[load.index];
    else if (load.from == From::kStates)
      series = &recording.states[static_cast<std::size_t>(load.index)];
    else if (load.index == kIntervalIndex)
      number[n] = s.dt;
    else if (load.index == kTimeIndex)
      series = &s.t;
    else if (load.index < static_cast<int>(kNumRoles))
      series = &s.input[static_cast<std::size_t>(load.index)];
    else if (load.index == static_cast<int>(FormSignal::kActive))
      series = &s.active;
    else
      series = load.index == static_cast<int>(FormSignal::kRetreating) ? recording.retreating : recording.law;
    varies[n] = series != nullptr;
    if (series != nullptr) whole[n] = series->data();
  }
  std::vector<Vector> outputs(outputs_.size(), Vector(rows));
  std::vector<double> space(operations_.size() * static_cast<std::size_t>(kBlock), 0.0);
  std::array<double, static_cast<std::size_t>(kBlock)> padded{};
  for (Eigen::Index first = 0; first < rows; first += kBlock) {
    const Eigen::Index count = std::min(kBlock, rows - first);
    const auto operand = [&](std::size_t n) -> Operand {
      if (!varies[n]) return {&number[n], 0};
      return {n < loads_.size() ? whole[n] + first : &space[(n - loads_.size()) * static_cast<std::size_t>(kBlock)], 1};
    };
    for (std::size_t k = 0; k < operations_.size(); ++k) {
      const Operation& of = operations_[k];
      const std::size_t n = loads_.size() + k;
      double* out = &space[k * static_cast<std::size_t>(kBlock)];
      std::array<Operand, expression::kMaxArguments> x{};
      bool any = false;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const auto argument = static_cast<std::size_t>(of.argument[i]);
        x[i] = operand(argument);
        any = any || (static_cast<int>(i) < expression::InfoOf(of.op).arguments && varies[argument]);
      }
      if (of.op == Op::kPrevious) {
        const double before = first == 0 ? x[0][0] : last[n];
        last[n] = x[0][count - 1];
        Fill(count, out, [&](Eigen::Index i) { return i == 0 ? before : x[0][i - 1]; });
      } else if (of.op == Op::kDelay) {
        Delay(whole[static_cast<std::size_t>(of.argument[0])], x[1][0] / s.dt, first, count, out);
      } else if (!any) {
        number[n] = Value(of.op, of.whole, x[0][0], x[1][0], x[2][0]);
        continue;
      } else if (IsElementary(of.op)) {
        std::copy_n(x[0].data, count, padded.begin());
        expression::Elementary(of.op, static_cast<std::size_t>(kBlock), padded.data(), nullptr, out);
      } else {
        OfEach(of.op, of.whole, count, x, out);
      }
      varies[n] = true;
    }
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      const Operand of = operand(static_cast<std::size_t>(outputs_[i]));
      Fill(count, outputs[i].data() + first, [&](Eigen::Index row) { return of[row]; });
    }
  }
  return outputs;
}

}  // namespace armcmc::gap
