#pragma once

#include <algorithm>
#include <cmath>

namespace armcmc::support {

/// Samples of one pack of measured data where nothing else decides: those of 0.1 s where that is 20 at least, else 100.
/// @param dt    s, sample interval.
/// @param most  That a pack holds.
[[nodiscard]] inline int SuitablePackLength(double dt, int most) {
  constexpr double kPeriod = 0.1;  // s
  constexpr long kFew = 20, kUsual = 100;
  const long samples = std::lround(std::min(kPeriod / dt, 1e6));
  return static_cast<int>(std::min<long>(samples < kFew ? kUsual : samples, most));
}

}  // namespace armcmc::support
