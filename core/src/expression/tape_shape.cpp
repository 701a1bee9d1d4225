#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

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

/// Takes apart code that adds products with powers to a sum, from its result back.
class PowerShape {
 public:
  PowerShape(const VirtualCode& code, int num_parameters) : code_(code.code), num_parameters_(num_parameters) {}

  /// @return whether `value` is of that shape; fills in what a tape says of it.
  [[nodiscard]] bool Recognise(int value, Tape* tape) const {
    const Virtual* v = Of(value);
    while (v != nullptr && (v->op == TapeOp::kMultiplyAdd || v->op == TapeOp::kMultiplyAddS)) {
      if (tape->num_powers == kMaxShapePowers) return false;
      TapePower& power = tape->power[static_cast<std::size_t>(tape->num_powers++)];
      const int x = v->registers[0];
      const int y = v->registers[1];
      if (!IsPowerTimes(x, y, &power) && !IsPowerTimes(y, x, &power)) return false;
      if (v->op == TapeOp::kMultiplyAddS) {
        tape->rest.constant = static_cast<std::uint8_t>(v->scalars[0]);
        return true;
      }
      if (v->registers[2] < num_parameters_) {
        tape->rest = Parameter(v->registers[2]);
        return true;
      }
      v = Of(v->registers[2]);
    }
    const std::optional<TapeSum> rest = v == nullptr ? std::nullopt : SumOf(*v, num_parameters_);
    if (rest) tape->rest = *rest;
    return rest && tape->num_powers > 0;
  }

 private:
  [[nodiscard]] const Virtual* Of(int value) const {
    const auto it = std::find_if(code_.begin(), code_.end(), [value](const Virtual& v) { return v.to == value; });
    return it == code_.end() ? nullptr : &*it;
  }
  /// Whether x is a power and y a parameter or a sum; beside a parameter the power may have a scalar as factor.
  bool IsPowerTimes(int x, int y, TapePower* power) const {
    const Virtual* v = Of(x);
    const Virtual* const sum = Of(y);
    std::optional<TapeSum> factor = y < num_parameters_ ? Parameter(y)
                                    : sum == nullptr    ? std::nullopt
                                                        : SumOf(*sum, num_parameters_);
    if (!factor || v == nullptr) return false;
    if (v->op == TapeOp::kScale && y < num_parameters_) {
      factor->scalar[0] = static_cast<std::uint8_t>(v->scalars[0]);
      v = Of(v->registers[0]);
    }
    if (v == nullptr || v->op != TapeOp::kExp2S || v->registers[0] >= num_parameters_) return false;
    power->factor = *factor;
    power->exponent = static_cast<std::uint8_t>(v->registers[0]);
    power->log2 = static_cast<std::uint8_t>(v->scalars[0]);
    return true;
  }

  const std::vector<Virtual>& code_;
  int num_parameters_;
};

}  // namespace

void RecogniseShape(const VirtualCode& code, Tape* tape) {
  if (code.results.size() != 1 || code.code.empty()) return;
  if (std::any_of(code.code.begin(), code.code.end(), [](const Virtual& v) { return v.once; })) return;
  if (code.code.size() == 1 && code.code[0].to == code.results[0]) {
    const std::optional<TapeSum> sum = SumOf(code.code[0], tape->num_parameters + tape->num_states);
    if (!sum) return;
    tape->rest = *sum;
    tape->shape = TapeShape::kLinear;
    return;
  }
  // What powers are part of reads no states: its loop runs from the parameters alone.
  if (tape->num_states > 0) return;
  if (PowerShape(code, tape->num_parameters).Recognise(code.results[0], tape))
    tape->shape = TapeShape::kPower;
  else
    tape->num_powers = 0;
}

}  // namespace armcmc::expression
