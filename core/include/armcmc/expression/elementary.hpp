#pragma once

#include <cstddef>

#include "armcmc/expression/operation.hpp"

namespace armcmc::expression {

/// What `count` has to be a multiple of in Elementary().
inline constexpr std::size_t kElementaryStride = 16;

/// out[i] = op(a[i], b[i]) by vector instructions, for exp, log, sin, cos, tan, atan, tanh and powers: within some
/// 1e-15 of the larger of the result and 1; trigonometric functions for |a| up to 1e7, exp up to 1e300, and powers of a
/// base >= 0 (NaN below). As the laws of packs are computed.
/// @param b  Of powers; else anything, as null.
/// @return false for other operations: nothing was done.
/// @rt Not for stages, which call the kernels directly.
bool Elementary(Op op, std::size_t count, const double* a, const double* b, double* out) noexcept;

}  // namespace armcmc::expression
