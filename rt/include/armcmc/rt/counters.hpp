#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/pack_codec.hpp"

namespace armcmc::rt {

/// The stages of the pipeline that have a deadline, in the order in which a pack passes them. Publishing is not one of
/// them: it runs on a thread with a lower priority, after the estimate is finished.
enum class Stage : std::uint8_t { kCollect = 0, kAdjust = 1, kExecute = 2 };
inline constexpr std::size_t kNumStages = 3;
/// Position of a stage in arrays of kNumStages elements.
[[nodiscard]] constexpr std::size_t IndexOf(Stage stage) noexcept { return static_cast<std::size_t>(stage); }

/// A number that one thread writes and any thread reads.
///
/// Reads and writes are relaxed: a reader sees some recent value of each counter, and two counters may be from
/// different moments. Add() is a load and a store, which is correct with a single writer and cheaper than an atomic
/// addition.
/// @rt Wait-free.
class Counter {
 public:
  /// Adds to the value. Only by the thread that owns the counter.
  void Add(std::int64_t n = 1) noexcept ARMCMC_NONBLOCKING { Set(Get() + n); }
  /// Sets the value, e.g. to a total that is kept elsewhere. Only by the owner.
  void Set(std::int64_t value) noexcept ARMCMC_NONBLOCKING { value_.store(value, std::memory_order_relaxed); }
  /// Current value. Any thread.
  [[nodiscard]] std::int64_t Get() const noexcept ARMCMC_NONBLOCKING { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::int64_t> value_{0};
};

/// FAULT_* bits of estimator_status_t, raised by any thread and collected until the next status message.
/// @rt Wait-free.
class FaultFlags {
 public:
  /// Sets bits; those already set remain.
  void Raise(std::int32_t flags) noexcept ARMCMC_NONBLOCKING { flags_.fetch_or(flags, std::memory_order_relaxed); }
  /// Returns all bits raised since the last call, and clears them. By the publish stage, once for each status message.
  [[nodiscard]] std::int32_t Take() noexcept { return flags_.exchange(0, std::memory_order_relaxed); }

 private:
  std::atomic<std::int32_t> flags_{0};
};

/// Everything that the stages of one plant count since the start, grouped by the thread that writes it. The groups do
/// not share cache lines, so that counting in one stage does not slow down another. estimator_status_t publishes all of
/// them; names and units are in lcm_types/README.md.
struct Counters {
  /// Packs that arrived.
  ///   received        usable packs
  ///   lost            gaps in the pack numbers; duplicate, reordered: numbers that came again or late
  ///   restarts        the plant began a new run; silent_periods: periods without a pack
  ///   ring_full       packs that found the ring to adjust full
  ///   foreign         messages of another type; fragments, malformed: datagrams that are not a complete message
  ///   rejected        packs that failed a check, by RejectCause
  struct alignas(64) Collect {
    Counter received, lost, duplicate, reordered, restarts, silent_periods, ring_full;
    Counter foreign, fragments, malformed;
    std::array<Counter, kNumRejectCauses> rejected;  ///< By RejectCause.
    std::atomic<bool> silent{true};                  ///< No pack for longer than a period and a half.
  } collect;
  /// Packs that were not computed (dropped), whose draws the deadline cut (truncated), and whose posterior was not
  /// finite (numeric).
  struct alignas(64) Adjust {
    Counter dropped, truncated, numeric;  ///< Packs.
  } adjust;
  /// Finished steps, the number of the newest pack, and estimates that the publisher had no room for.
  struct alignas(64) Execute {
    Counter steps, last_seq, unpublished;
  } execute;
  /// Messages sent, and messages that could not be encoded or sent.
  struct alignas(64) Publish {
    Counter errors, messages;  ///< Messages.
  } publish;
  alignas(64) FaultFlags faults;
  alignas(64) std::array<Counter, kNumStages> heap_calls;  ///< Heap calls of each stage thread, after warm-up.

  /// Rejected packs of all causes. Any thread, as for the two below.
  [[nodiscard]] std::int64_t Rejected() const noexcept {
    std::int64_t sum = 0;
    for (const Counter& counter : collect.rejected) sum += counter.Get();
    return sum;
  }
  /// Rejected packs of the causes in a group: values, sizes, types.
  [[nodiscard]] std::int64_t Rejected(RejectGroup group) const noexcept {
    std::int64_t sum = 0;
    for (std::size_t i = 1; i < kNumRejectCauses; ++i) {
      if (GroupOf(static_cast<RejectCause>(i)) == group) sum += collect.rejected[i].Get();
    }
    return sum;
  }
  /// Usable packs that no estimate was computed from: dropped by adjust, or lost to a full ring.
  [[nodiscard]] std::int64_t Dropped() const noexcept { return adjust.dropped.Get() + collect.ring_full.Get(); }
};

}  // namespace armcmc::rt
