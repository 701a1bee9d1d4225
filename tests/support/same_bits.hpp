#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

namespace armcmc::test {

/// Whether two numbers have the same bits: unlike under ==, a NaN equals itself, and -0 differs from 0.
inline bool SameBits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

/// Whether two arrays have the same size and the same bits.
inline bool SameBits(std::span<const double> a, std::span<const double> b) {
  return std::ranges::equal(a, b, [](double x, double y) { return SameBits(x, y); });
}

}  // namespace armcmc::test
