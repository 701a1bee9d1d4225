#pragma once

#include <cmath>

namespace armcmc {

/// The arithmetic that laws and effects are written in, for one number at a time. The scoring kernels hand in vectors
/// of candidates instead; what a formula says is written once.
struct ScalarOps {
  using V = double;
  static V Set(double a) noexcept { return a; }
  static V Fma(V a, V b, V c) noexcept { return a * b + c; }
  static V Max(V a, V b) noexcept { return a > b ? a : b; }
  static V Min(V a, V b) noexcept { return a < b ? a : b; }
  static V Abs(V a) noexcept { return std::fabs(a); }
  static V Sqrt(V a) noexcept { return std::sqrt(a); }
  static V Exp2(V a) noexcept { return std::exp2(a); }
  static V CopySign(V size, V sign) noexcept { return std::copysign(size, sign); }
};

}  // namespace armcmc
