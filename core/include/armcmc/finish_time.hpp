#pragma once

#include <algorithm>

#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc {

/// Time that a pack takes after its last draw, predicted from the previous packs.
///
/// Part of that time is the same for any number of draws (fits, climbing to the mode), part grows with it. So fewer
/// draws than the largest number that was timed are assumed to take as long as those, more of them in proportion. A
/// truncated pack does not make the next full one look longer than it is, or one truncation would cause another.
class FinishTime {
 public:
  /// @param draws  > 0. @return ns; 0 before the first pack.
  [[nodiscard]] Nanos Predict(int draws) const noexcept ARMCMC_NONBLOCKING {
    if (draws <= draws_) return ns_;
    return draws_ > 0 ? ns_ * draws / draws_ : 0;
  }

  /// A stall of the machine here does not predict the next pack: it may double the prediction at most, while work
  /// that has become slower for good is followed within a few packs.
  void Add(Nanos spent_ns, int draws) noexcept ARMCMC_NONBLOCKING {
    const Nanos predicted_ns = Predict(draws);
    const Nanos limited_ns = predicted_ns > 0 ? std::min(spent_ns, 2 * predicted_ns) : spent_ns;
    ns_ = std::max(predicted_ns - predicted_ns / 10, limited_ns);
    draws_ = std::max(draws_, draws);
  }

 private:
  Nanos ns_ = 0;
  int draws_ = 0;  // the most so far; they take ns_
};

}  // namespace armcmc
