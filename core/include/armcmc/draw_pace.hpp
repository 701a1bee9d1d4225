#pragma once

#include <algorithm>

#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

/// How much slower the draws of a pack come than those of the packs before it.
///
/// A core that is clocked down, or that two threads share, is slow for the whole of a pack: the work that remains
/// after the draws will be slow, too.
class DrawPace {
 public:
  static constexpr double kMost = 3.0;  ///< A stall in between does not predict what comes after it.

  /// @param spent_ns  On `draws` draws, > 0. @return 1 for the usual pace and faster ones, kMost at most.
  [[nodiscard]] double Slowness(Nanos spent_ns, int draws) const noexcept ARMCMC_NONBLOCKING {
    return usual_ns_ > 0.0 ? std::clamp(PerDraw(spent_ns, draws) / usual_ns_, 1.0, kMost) : 1.0;
  }

  /// Work that has become slower for good is the usual pace after some ten packs.
  void Add(Nanos spent_ns, int draws) noexcept ARMCMC_NONBLOCKING {
    constexpr double kNewest = 1.0 / 8.0;
    const double now_ns = PerDraw(spent_ns, draws);
    usual_ns_ = usual_ns_ > 0.0 ? usual_ns_ + kNewest * (std::min(now_ns, kMost * usual_ns_) - usual_ns_) : now_ns;
  }

 private:
  static double PerDraw(Nanos spent_ns, int draws) noexcept { return static_cast<double>(spent_ns) / draws; }

  double usual_ns_ = 0.0;  // for one draw; 0 before the first pack
};

}  // namespace armcmc
