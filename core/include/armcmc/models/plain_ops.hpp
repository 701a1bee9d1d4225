#pragma once

#include <cmath>

namespace armcmc {

/// The arithmetic that a model's Predict needs, of the standard library and for one candidate.
struct PlainOps {
  using V = double;
  static V Set(double a) noexcept { return a; }
  static V Exp2(double a) noexcept { return std::exp2(a); }
  static V Fma(double a, double b, double c) noexcept { return a * b + c; }
};

}  // namespace armcmc
