#include <optional>

#include "expression/virtual_code.hpp"

namespace armcmc::expression {
namespace {

/// The sum that the instruction at `at` computes from parameters; none where it is something else.
std::optional<TapeSum> SumAt(const Tape& tape, int at) {
  const TapeInstruction& i = tape.code[static_cast<std::size_t>(at)];
  const bool from_register = i.op == TapeOp::kAddLinear;
  if ((i.op != TapeOp::kLinear && !from_register) || i.b + (from_register ? 1 : 0) > kMaxShapeTerms)
    return std::nullopt;
  TapeSum sum;
  if (from_register) {
    sum.parameter[sum.count] = i.a;
    sum.scalar[sum.count++] = TapeSum::kNone;
  } else {
    sum.constant = i.a;
  }
  for (std::size_t t = 0; t < i.b; ++t) {
    const TapeInstruction& pair = tape.code[static_cast<std::size_t>(at) + 1 + t / 2];
    sum.parameter[sum.count] = t % 2 == 0 ? pair.to : pair.b;
    sum.scalar[sum.count++] = t % 2 == 0 ? pair.a : pair.c;
  }
  for (std::size_t t = 0; t < sum.count; ++t)
    if (sum.parameter[t] >= tape.num_parameters) return std::nullopt;
  return sum;
}

int LengthAt(const Tape& tape, int at) {
  const TapeInstruction& i = tape.code[static_cast<std::size_t>(at)];
  return i.op == TapeOp::kLinear || i.op == TapeOp::kAddLinear ? 1 + (i.b + 1) / 2 : 1;
}

}  // namespace

void RecogniseShape(Tape* tape) {
  if (tape->once != 0 || tape->num_results != 1 || tape->num_states != 0) return;
  std::array<int, 4> start{};
  int count = 0;
  for (int at = 0; at < tape->size; at += LengthAt(*tape, at)) {
    if (count == static_cast<int>(start.size())) return;
    start[static_cast<std::size_t>(count++)] = at;
  }
  const auto code = [&](int n) -> const TapeInstruction& {
    return tape->code[static_cast<std::size_t>(start[static_cast<std::size_t>(n)])];
  };
  if (count == 1) {
    const std::optional<TapeSum> sum = SumAt(*tape, 0);
    if (!sum) return;
    tape->rest = *sum;
    tape->shape = TapeShape::kLinear;
    return;
  }
  // A power, its factor (a sum or a parameter), and their product, added to a scalar or a sum; in any order.
  if (count < 2) return;
  const TapeInstruction& last = code(count - 1);
  const bool adds_scalar = last.op == TapeOp::kMultiplyAddS;
  if (!adds_scalar && last.op != TapeOp::kMultiplyAdd) return;
  const TapeInstruction* power = nullptr;
  for (int n = 0; n + 1 < count; ++n)
    if (code(n).op == TapeOp::kExp2S && power == nullptr) power = &code(n);
  if (power == nullptr || power->a >= tape->num_parameters || (last.a != power->to && last.b != power->to)) return;
  const std::uint8_t other = last.a == power->to ? last.b : last.a;
  std::optional<TapeSum> factor;
  std::optional<TapeSum> rest;
  if (other < tape->num_parameters) {
    factor.emplace();
    factor->count = 1;
    factor->parameter[0] = other;
    factor->scalar[0] = TapeSum::kNone;
  }
  if (adds_scalar) rest.emplace().constant = last.c;
  for (int n = 0; n + 1 < count; ++n) {
    if (&code(n) == power) continue;
    const std::optional<TapeSum> sum = SumAt(*tape, start[static_cast<std::size_t>(n)]);
    if (!sum) return;
    if (code(n).to == other && !factor) {
      factor = sum;
    } else if (!adds_scalar && code(n).to == last.c && !rest) {
      rest = sum;
    } else {
      return;
    }
  }
  if (!factor || !rest) return;
  tape->factor = *factor;
  tape->rest = *rest;
  tape->exponent = power->a;
  tape->log2 = power->b;
  tape->shape = TapeShape::kPower;
}

}  // namespace armcmc::expression
