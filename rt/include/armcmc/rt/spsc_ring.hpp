#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>

#include "armcmc/nonblocking.hpp"

namespace armcmc::rt {

/// Distance that keeps two variables on different cache lines. Fixed, since
/// std::hardware_destructive_interference_size may differ between the files of one program.
inline constexpr std::size_t kCacheLine = 64;

/// Single-producer single-consumer ring of fixed capacity (L. Lamport, 1983). Elements are written and read in place:
/// nothing is copied, nothing is allocated after construction, and neither side waits for the other.
///
/// Producer: Claim(), fill, Commit(). Consumer: Front(), use, Pop(). A committed element is visible to the consumer
/// with everything written before (release / acquire on the indices). The indices count up without wrapping and are
/// reduced by a mask, so that all kCapacity slots can be used.
/// @code
/// if (Pack* slot = ring.Claim()) { Fill(slot); ring.Commit(); }               // producer
/// while (Pack* pack = ring.Front()) { Use(*pack); ring.Pop(); }               // consumer
/// @endcode
/// @tparam T          Default constructible; objects live as long as the ring and are reused.
/// @tparam kCapacity  Number of elements, a power of two.
template <typename T, std::size_t kCapacity>
class SpscRing {
  static_assert(kCapacity >= 2 && (kCapacity & (kCapacity - 1)) == 0, "capacity must be a power of two");

 public:
  /// Allocates all slots.
  SpscRing() : slots_(std::make_unique<std::array<T, kCapacity>>()) {}

  /// The slot to fill next. The same slot until Commit().
  /// @return null if the ring is full: the producer decides what is lost.
  /// @rt Wait-free.
  [[nodiscard]] T* Claim() noexcept ARMCMC_NONBLOCKING {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == kCapacity) return nullptr;
    return &(*slots_)[head & (kCapacity - 1)];
  }

  /// Hands the claimed slot to the consumer. @pre Claim() returned a slot. @rt Wait-free.
  void Commit() noexcept ARMCMC_NONBLOCKING {
    head_.store(head_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// The oldest element. The same element until Pop().
  /// @return null if the ring is empty.
  /// @rt Wait-free.
  [[nodiscard]] T* Front() noexcept ARMCMC_NONBLOCKING {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (head_.load(std::memory_order_acquire) == tail) return nullptr;
    return &(*slots_)[tail & (kCapacity - 1)];
  }

  /// Gives the slot of Front() back to the producer. @pre Front() returned an element. @rt Wait-free.
  void Pop() noexcept ARMCMC_NONBLOCKING {
    tail_.store(tail_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// Number of committed elements that were not popped: exact for producer and consumer, a snapshot for other threads.
  /// @rt Wait-free.
  [[nodiscard]] std::size_t size() const noexcept ARMCMC_NONBLOCKING {
    const std::size_t tail = tail_.load(std::memory_order_acquire);
    return head_.load(std::memory_order_acquire) - tail;
  }

  /// Number of elements that fit.
  [[nodiscard]] static constexpr std::size_t capacity() noexcept { return kCapacity; }

 private:
  alignas(kCacheLine) std::atomic<std::size_t> head_{0};  // written by the producer
  alignas(kCacheLine) std::atomic<std::size_t> tail_{0};  // written by the consumer
  alignas(
      kCacheLine) std::unique_ptr<std::array<T, kCapacity>> slots_;  ///< On the heap, so that the ring can be a member.
};

}  // namespace armcmc::rt
