#pragma once

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/log_histogram.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// How old data are when their estimate has been handed to the bus, ns:
///
///     from_arrival  its publication minus the arrival of the pack, both on this computer's CLOCK_MONOTONIC,
///     from_sample   its publication minus t_last of the pack, the plant's clock at the last sample: the bus included.
///
/// The clock of a plant on another computer has another zero. What it says is not counted then: an age that is negative
/// or above kMostAge.
///
/// One writer, the publishing thread; readers only after it has ended.
class PublicationLatency {
 public:
  /// Largest age that is counted, ns.
  static constexpr Nanos kMostAge = 10'000'000'000;

  /// Adds one publication. @param t_last_ns  Clock of the plant. @param arrival_ns, published_ns  CLOCK_MONOTONIC. @rt
  /// O(1).
  void Add(Nanos t_last_ns, Nanos arrival_ns, Nanos published_ns) noexcept ARMCMC_NONBLOCKING {
    from_arrival_.Add(published_ns - arrival_ns);
    // t_last is whatever a message says: no difference that could overflow.
    if (t_last_ns <= published_ns && t_last_ns >= published_ns - kMostAge) from_sample_.Add(published_ns - t_last_ns);
  }

  /// Ages since the arrival of the pack, ns.
  [[nodiscard]] const LogHistogram& from_arrival() const noexcept { return from_arrival_; }
  [[nodiscard]] const LogHistogram& from_sample() const noexcept { return from_sample_; }

 private:
  LogHistogram from_arrival_, from_sample_;
};

}  // namespace armcmc::rt
