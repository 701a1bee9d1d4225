#include <algorithm>
#include <optional>

#include "expression/virtual_code.hpp"

namespace armcmc::expression {
namespace {

TapeSum Parameter(int parameter) {
  TapeSum sum;
  sum.count = 1;
  sum.parameter[0] = static_cast<std::uint8_t>(parameter);
  sum.scalar[0] = TapeSum::kNone;
  return sum;
}

/// The sum of given values that an instruction computes; none if it is another instruction.
std::optional<TapeSum> SumOf(const Virtual& v, int num_given) {
  if (v.op == TapeOp::kScale && v.registers[0] < num_given) {
    TapeSum sum = Parameter(v.registers[0]);
    sum.scalar[0] = static_cast<std::uint8_t>(v.scalars[0]);
    return sum;
  }
  if ((v.op != TapeOp::kLinear && v.op != TapeOp::kAddLinear) || v.registers.size() > kMaxShapeTerms)
    return std::nullopt;
  TapeSum sum;
  const bool from_register = v.op == TapeOp::kAddLinear;
  if (!from_register) sum.constant = static_cast<std::uint8_t>(v.scalars[0]);
  for (std::size_t t = 0; t < v.registers.size(); ++t) {
    if (v.registers[t] >= num_given) return std::nullopt;
    const std::size_t scalar = from_register ? t - 1 : t + 1;
    sum.parameter[t] = static_cast<std::uint8_t>(v.registers[t]);
    sum.scalar[t] = from_register && t == 0 ? TapeSum::kNone : static_cast<std::uint8_t>(v.scalars[scalar]);
  }
  sum.count = static_cast<std::uint8_t>(v.registers.size());
  return sum;
}

}  // namespace

void RecogniseShape(const VirtualCode& code, Tape* tape) {
  if (code.results.size() != 1 || code.code.empty() || code.code.size() > 4) return;
  if (std::any_of(code.code.begin(), code.code.end(), [](const Virtual& v) { return v.once; })) return;
  const Virtual& last = code.code.back();
  if (last.to != code.results[0]) return;
  if (code.code.size() == 1) {
    const std::optional<TapeSum> sum = SumOf(last, tape->num_parameters + tape->num_states);
    if (!sum) return;
    tape->rest = *sum;
    tape->shape = TapeShape::kLinear;
    return;
  }
  // What powers are part of reads no states: its loop runs from the parameters alone.
  if (tape->num_states > 0) return;
  const int num_parameters = tape->num_parameters;
  // A power, its factor (a sum or a parameter), and their product, added to a scalar or a sum; in any order.
  const bool adds_scalar = last.op == TapeOp::kMultiplyAddS;
  if (!adds_scalar && last.op != TapeOp::kMultiplyAdd) return;
  const auto power =
      std::find_if(code.code.begin(), code.code.end() - 1, [](const Virtual& v) { return v.op == TapeOp::kExp2S; });
  if (power == code.code.end() - 1 || power->registers[0] >= num_parameters) return;
  const int x = last.registers[0];
  const int y = last.registers[1];
  if (x != power->to && y != power->to) return;
  const int other = x == power->to ? y : x;
  std::optional<TapeSum> factor;
  std::optional<TapeSum> rest;
  if (other < num_parameters) factor = Parameter(other);
  if (adds_scalar) rest.emplace().constant = static_cast<std::uint8_t>(last.scalars[0]);
  for (auto v = code.code.begin(); v != code.code.end() - 1; ++v) {
    if (v == power) continue;
    const std::optional<TapeSum> sum = SumOf(*v, num_parameters);
    if (!sum) return;
    if (v->to == other && !factor) {
      factor = sum;
    } else if (!adds_scalar && v->to == last.registers[2] && !rest) {
      rest = sum;
    } else {
      return;
    }
  }
  if (!factor || !rest) return;
  tape->factor = *factor;
  tape->rest = *rest;
  tape->exponent = static_cast<std::uint8_t>(power->registers[0]);
  tape->log2 = static_cast<std::uint8_t>(power->scalars[0]);
  tape->shape = TapeShape::kPower;
}

}  // namespace armcmc::expression
