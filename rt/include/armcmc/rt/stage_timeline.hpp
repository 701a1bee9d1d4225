#pragma once

#include <algorithm>

#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// How much earlier an event would have come, ns >= 0, on three hypothetical time lines.
struct Earlier {
  Nanos without_lateness = 0;  ///< If no pack had been late.
  Nanos without_stalls = 0;    ///< If the machine had not stalled.
  Nanos without_both = 0;      ///< If neither had happened; at least the larger of the two.
};

/// One piece of work of a stage, CLOCK_MONOTONIC.
struct StageWork {
  Nanos ready_ns = 0;         ///< Its input was there.
  Nanos start_ns = 0;         ///< Begun: after the input came, the work before was done, and the thread was awake.
  Nanos end_ns = 0;           ///< Done.
  Nanos stall_before_ns = 0;  ///< Stalls of the machine from the moment that the stage could have begun to start_ns.
  Nanos stall_ns = 0;         ///< Stalls of the machine in [start_ns, end_ns].
};

/// The time line that a stage would have had without stalls and without late packs.
///
/// A stall does not only delay the step it hits: the stage comes later to the next one, too, until it has caught up.
/// Lindley's recursion for a queue with one server, once as it was and three times as it would have been:
///
///     start_k = max(ready_k, end_{k-1}) + wake-up,  end_k = start_k + work_k,
///
/// where ready, wake-up and work are shortened by what was late or stood still. Times that would have been are never
/// later than those that were. All times are CLOCK_MONOTONIC in ns; one thread.
/// Source: D. V. Lindley, The theory of queues with a single server, 1952.
class StageTimeline {
 public:
  /// When the stage could have begun with input that was there at ready_ns: max(ready_ns, end of the work before).
  /// @rt O(1).
  [[nodiscard]] Nanos EarliestStart(Nanos ready_ns) const noexcept ARMCMC_NONBLOCKING {
    return std::max(ready_ns, free_ns_);
  }

  /// How much earlier work would have begun that begins at start_ns.
  /// @param work   When its input was there, and when it began and ended.
  /// @param ready  How much earlier its input would have been there. @rt O(1).
  [[nodiscard]] Earlier Begin(const StageWork& work, const Earlier& ready) const noexcept ARMCMC_NONBLOCKING {
    const Nanos begin = EarliestStart(work.ready_ns);
    const auto gained = [&](Nanos ready_gain, Nanos free_gain) {
      return begin - std::max(work.ready_ns - ready_gain, free_ns_ - free_gain);
    };
    return {gained(ready.without_lateness, free_.without_lateness),
            gained(ready.without_stalls, free_.without_stalls) + work.stall_before_ns,
            gained(ready.without_both, free_.without_both) + work.stall_before_ns};
  }

  /// Work that was done, in the order of its beginning.
  /// @param work, ready  As for Begin().
  /// @return how much earlier it would have been finished. @rt O(1).
  Earlier Do(const StageWork& work, const Earlier& ready) noexcept ARMCMC_NONBLOCKING {
    free_ = Begin(work, ready);
    Continue(work.end_ns, work.stall_ns);
    return free_;
  }

  /// The stage was busy with what it did last until end_ns, of which stalls took stall_ns. @rt O(1).
  void Continue(Nanos end_ns, Nanos stall_ns) noexcept ARMCMC_NONBLOCKING {
    free_.without_stalls += stall_ns;
    free_.without_both += stall_ns;
    free_ns_ = end_ns;
  }

  /// Work that was given up at start_ns instead of being done: it would have taken work_ns on the other time lines.
  /// @return how much earlier it would have begun. @rt O(1).
  Earlier GiveUp(const StageWork& work, const Earlier& ready, Nanos work_ns) noexcept ARMCMC_NONBLOCKING {
    const Earlier begin = Begin(work, ready);
    free_ = {std::max<Nanos>(0, begin.without_lateness - work_ns), std::max<Nanos>(0, begin.without_stalls - work_ns),
             std::max<Nanos>(0, begin.without_both - work_ns)};
    free_ns_ = std::max(free_ns_, work.start_ns);
    return begin;
  }

 private:
  Nanos free_ns_ = 0;  // end of the newest work
  Earlier free_;       // how much earlier that would have been
};

}  // namespace armcmc::rt
