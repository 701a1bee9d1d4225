#pragma once

#include <cmath>
#include <limits>

#include "armcmc/expression/operation.hpp"
#include "armcmc/nonblocking.hpp"

namespace armcmc::expression {

/// Value of an operation without memory. Conditions are 1 or 0; min and max of what is not a number are not a number.
/// @rt No heap, no lock, no throw.
[[nodiscard]] inline double Evaluate(Op op, double a, double b, double c) noexcept ARMCMC_NONBLOCKING {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  switch (op) {
    case Op::kAdd: return a + b;
    case Op::kSubtract: return a - b;
    case Op::kMultiply: return a * b;
    case Op::kDivide: return a / b;
    case Op::kPower: return std::pow(a, b);
    case Op::kNegate: return -a;
    case Op::kLess: return a < b ? 1.0 : 0.0;
    case Op::kLessEqual: return a <= b ? 1.0 : 0.0;
    case Op::kEqual: return a == b ? 1.0 : 0.0;
    case Op::kNotEqual: return a != b ? 1.0 : 0.0;
    case Op::kAnd: return a != 0.0 && b != 0.0 ? 1.0 : 0.0;
    case Op::kOr: return a != 0.0 || b != 0.0 ? 1.0 : 0.0;
    case Op::kNot: return a == 0.0 ? 1.0 : 0.0;
    case Op::kAbs: return std::fabs(a);
    case Op::kSign: return a > 0.0 ? 1.0 : a < 0.0 ? -1.0 : a;
    case Op::kSqrt: return std::sqrt(a);
    case Op::kExp: return std::exp(a);
    case Op::kLog: return std::log(a);
    case Op::kLog2: return std::log2(a);
    case Op::kLog10: return std::log10(a);
    case Op::kSin: return std::sin(a);
    case Op::kCos: return std::cos(a);
    case Op::kTan: return std::tan(a);
    case Op::kAsin: return std::asin(a);
    case Op::kAcos: return std::acos(a);
    case Op::kAtan: return std::atan(a);
    case Op::kTanh: return std::tanh(a);
    case Op::kMin: return a != a || b != b ? kNan : a < b ? a : b;
    case Op::kMax: return a != a || b != b ? kNan : a > b ? a : b;
    case Op::kClamp:
      return Evaluate(Op::kMin, Evaluate(Op::kMax, a, b, 0.0), c, 0.0);  // NOLINT(misc-no-recursion): once
    case Op::kStep: return a != a ? kNan : a >= 0.0 ? 1.0 : 0.0;
    case Op::kIf: return a != 0.0 ? b : c;
    default: return kNan;
  }
}

}  // namespace armcmc::expression
