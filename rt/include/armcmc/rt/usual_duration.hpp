#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// What something takes while the machine does not stand still, and from that how long it did.
///
/// A witness wakes up now and then, so of a slice as long as its period it sees half on average. When what it saw is at
/// least half of what something took beyond the longest of its last undisturbed times, the machine took all of that.
/// Else nothing is added to what was seen: in doubt a stage was slow itself.
class UsualDuration {
 public:
  /// @param duration_ns  It took. @param seen_ns  Of that, as witnessed.
  /// @return time that the machine stood still, in [seen_ns, duration_ns]. @rt O(kWindow).
  [[nodiscard]] Nanos Stalled(Nanos duration_ns, Nanos seen_ns) noexcept ARMCMC_NONBLOCKING {
    if (seen_ns <= 0) {
      undisturbed_ns_[next_++ % kWindow] = duration_ns;
      return 0;
    }
    if (next_ < kWindow) return seen_ns;
    const Nanos excess_ns = duration_ns - *std::max_element(undisturbed_ns_.begin(), undisturbed_ns_.end());
    return 2 * seen_ns >= excess_ns ? std::max(seen_ns, excess_ns) : seen_ns;
  }

 private:
  static constexpr std::size_t kWindow = 32;
  std::array<Nanos, kWindow> undisturbed_ns_{};
  std::size_t next_ = 0;
};

}  // namespace armcmc::rt
