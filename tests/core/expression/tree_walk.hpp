#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <string>

#include "armcmc/expression/syntax.hpp"

namespace armcmc::test {

/// Value of an expression without memory, straight from its syntax: what the tape is measured by.
template <class Number>
class TreeWalk {
 public:
  TreeWalk(const expression::Syntax& syntax, const std::map<std::string, Number>& values)
      : syntax_(syntax), values_(values) {}

  Number Value() const { return Node(syntax_.root()); }
  /// After Value(): a part of it was infinite or not a number.
  [[nodiscard]] bool overflowed() const noexcept { return overflowed_; }

 private:
  static auto Real(const Number& x) {
    if constexpr (requires { x.real(); }) {
      return x.real();
    } else {
      return x;
    }
  }
  static bool IsNan(const Number& x) { return std::isnan(Real(x)); }
  static Number Truth(bool yes) { return yes ? Number(1) : Number(0); }

  Number Node(int node) const {
    const Number value = Computed(node);
    overflowed_ = overflowed_ || !std::isfinite(Real(value));
    return value;
  }

  Number Computed(int node) const {
    using expression::Op;
    const expression::SyntaxNode& at = syntax_.at(node);
    const auto a = [&] { return Node(at.argument[0]); };
    const auto b = [&] { return Node(at.argument[1]); };
    const auto c = [&] { return Node(at.argument[2]); };
    switch (at.op) {
      case Op::kNumber: return Number(at.value);
      case Op::kSymbol: return values_.at(at.name);
      case Op::kAdd: return a() + b();
      case Op::kSubtract: return a() - b();
      case Op::kMultiply: return a() * b();
      case Op::kDivide: return a() / b();
      case Op::kPower:
        // pow of a complex 0 is not a number.
        return Real(a()) == 0 && Real(b()) > 0 ? Number(0) : std::pow(a(), b());
      case Op::kNegate: return -a();
      case Op::kLess: return Truth(Real(a()) < Real(b()));
      case Op::kLessEqual: return Truth(Real(a()) <= Real(b()));
      case Op::kEqual: return Truth(Real(a()) == Real(b()));
      case Op::kNotEqual: return Truth(Real(a()) != Real(b()));
      case Op::kAnd: return Truth(Real(a()) != 0 && Real(b()) != 0);
      case Op::kOr: return Truth(Real(a()) != 0 || Real(b()) != 0);
      case Op::kNot: return Truth(Real(a()) == 0);
      case Op::kAbs: return Real(a()) < 0 ? -a() : a();
      case Op::kSign: return IsNan(a()) ? a() : Number(Real(a()) > 0 ? 1 : Real(a()) < 0 ? -1 : 0);
      case Op::kSqrt: return std::sqrt(a());
      case Op::kExp: return std::exp(a());
      case Op::kLog: return std::log(a());
      case Op::kLog2: return std::log(a()) / std::log(Number(2));
      case Op::kLog10: return std::log(a()) / std::log(Number(10));
      case Op::kSin: return std::sin(a());
      case Op::kCos: return std::cos(a());
      case Op::kTan: return std::tan(a());
      case Op::kAsin: return std::asin(a());
      case Op::kAcos: return std::acos(a());
      case Op::kAtan: return std::atan(a());
      case Op::kTanh: return std::tanh(a());
      case Op::kMin: return IsNan(a()) ? a() : IsNan(b()) || Real(b()) < Real(a()) ? b() : a();
      case Op::kMax: return IsNan(a()) ? a() : IsNan(b()) || Real(b()) > Real(a()) ? b() : a();
      case Op::kClamp: return Real(a()) < Real(b()) ? b() : Real(a()) > Real(c()) ? c() : a();
      case Op::kStep: return IsNan(a()) ? a() : Truth(Real(a()) >= 0);
      case Op::kIf: return Real(a()) != 0 ? b() : c();
      default: throw std::logic_error("memory");
    }
  }

  const expression::Syntax& syntax_;
  const std::map<std::string, Number>& values_;
  mutable bool overflowed_ = false;
};

}  // namespace armcmc::test
