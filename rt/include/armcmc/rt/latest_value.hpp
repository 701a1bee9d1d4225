#pragma once

#include <atomic>
#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/spsc_ring.hpp"

namespace armcmc::rt {

/// Triple buffer of slot numbers: hands the newest complete value from one thread to another.
///
/// The values themselves are kept by the caller, in kSlots slots. The writer fills write_slot() and calls Publish();
/// the reader calls Acquire() and then owns read_slot(). The third slot holds the newest value in between; an atomic
/// exchange of its number passes the ownership. No value is copied, neither side waits, and they never work on the same
/// slot. For one writer and one reader.
/// @code
/// slots[latest.write_slot()] = value;                              // writer
/// const bool lost = latest.Publish();
///
/// if (latest.Acquire()) Use(slots[latest.read_slot()]);            // reader
/// @endcode
class LatestValue {
 public:
  /// Number of slots that the caller provides.
  static constexpr int kSlots = 3;

  /// Slot owned by the writer. Only for the writer.
  [[nodiscard]] int write_slot() const noexcept { return write_slot_; }

  /// Hands write_slot() to the reader and takes another slot. What was written to the slot before is visible to the
  /// reader (acquire / release).
  /// @return true if the previous value had not been read: it is lost, and the new write_slot() still contains it.
  /// @rt Wait-free.
  [[nodiscard]] bool Publish() noexcept ARMCMC_NONBLOCKING {
    const std::uint8_t mine = static_cast<std::uint8_t>(write_slot_ | kFresh);
    const std::uint8_t before = shared_.exchange(mine, std::memory_order_acq_rel);
    write_slot_ = before & kSlotMask;
    return (before & kFresh) != 0;
  }

  /// true while the value handed over last has not been taken. For the writer. @rt Wait-free.
  [[nodiscard]] bool unread() const noexcept ARMCMC_NONBLOCKING {
    return (shared_.load(std::memory_order_relaxed) & kFresh) != 0;
  }

  /// Takes the newest value: read_slot() is then its slot, until the next call that returns true.
  /// @return false if nothing was published since the last call; read_slot() stays.
  /// @rt Wait-free.
  [[nodiscard]] bool Acquire() noexcept ARMCMC_NONBLOCKING {
    if ((shared_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    const std::uint8_t mine = static_cast<std::uint8_t>(read_slot_);
    read_slot_ = shared_.exchange(mine, std::memory_order_acq_rel) & kSlotMask;
    return true;
  }

  /// Slot owned by the reader. Only for the reader; valid after the first Acquire() that returned true.
  [[nodiscard]] int read_slot() const noexcept { return read_slot_; }

 private:
  /// Bit of shared_: its slot has not been read.
  static constexpr std::uint8_t kFresh = 0x80;
  /// Bits of shared_ that hold the slot number.
  static constexpr std::uint8_t kSlotMask = 0x03;

  /// Slot in between, with kFresh; each of the three members on a cache line of its own.
  alignas(kCacheLine) std::atomic<std::uint8_t> shared_{1};
  alignas(kCacheLine) int write_slot_ = 0;  // of the writer
  alignas(kCacheLine) int read_slot_ = 2;   // of the reader
};

}  // namespace armcmc::rt
