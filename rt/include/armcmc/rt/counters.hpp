#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/pack_codec.hpp"

namespace armcmc::rt {

enum class Stage : std::uint8_t { kCollect = 0, kAdjust = 1, kExecute = 2 };
inline constexpr std::size_t kNumStages = 3;
[[nodiscard]] constexpr std::size_t IndexOf(Stage stage) noexcept { return static_cast<std::size_t>(stage); }

/// A number that one thread counts and others read.
class Counter {
 public:
  void Add(std::int64_t n = 1) noexcept ARMCMC_NONBLOCKING { Set(Get() + n); }
  void Set(std::int64_t value) noexcept ARMCMC_NONBLOCKING { value_.store(value, std::memory_order_relaxed); }
  [[nodiscard]] std::int64_t Get() const noexcept ARMCMC_NONBLOCKING { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::int64_t> value_{0};
};

/// FAULT_* bits collected by all threads until the next status message takes them.
class FaultFlags {
 public:
  void Raise(std::int32_t flags) noexcept ARMCMC_NONBLOCKING { flags_.fetch_or(flags, std::memory_order_relaxed); }
  [[nodiscard]] std::int32_t Take() noexcept { return flags_.exchange(0, std::memory_order_relaxed); }

 private:
  std::atomic<std::int32_t> flags_{0};
};

/// Everything that the stages count, grouped by the one thread that writes it; cache lines are not shared.
struct Counters {
  struct alignas(64) Collect {
    Counter received, lost, duplicate, reordered, restarts, silent_periods, ring_full;
    Counter foreign, fragments, malformed;
    std::array<Counter, kNumRejectCauses> rejected;
    std::atomic<bool> silent{true};  ///< No pack for longer than a period and a half.
  } collect;
  struct alignas(64) Adjust {
    Counter dropped, truncated, numeric;
  } adjust;
  struct alignas(64) Execute {
    Counter steps, last_seq, unpublished;
  } execute;
  struct alignas(64) Publish {
    Counter errors, messages;
  } publish;
  alignas(64) FaultFlags faults;
  alignas(64) std::array<Counter, kNumStages> heap_calls;  ///< Of each stage thread, after warm-up.

  [[nodiscard]] std::int64_t Rejected() const noexcept {
    std::int64_t sum = 0;
    for (const Counter& counter : collect.rejected) sum += counter.Get();
    return sum;
  }
  [[nodiscard]] std::int64_t Rejected(RejectGroup group) const noexcept {
    std::int64_t sum = 0;
    for (std::size_t i = 1; i < kNumRejectCauses; ++i) {
      if (GroupOf(static_cast<RejectCause>(i)) == group) sum += collect.rejected[i].Get();
    }
    return sum;
  }
  [[nodiscard]] std::int64_t Dropped() const noexcept { return adjust.dropped.Get() + collect.ring_full.Get(); }
};

}  // namespace armcmc::rt
