#pragma once

#include <semaphore.h>

#include <atomic>

#include "armcmc/nonblocking.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// Wakes one thread from another; the wait is bounded by an absolute time of CLOCK_MONOTONIC.
///
/// A POSIX semaphore (sem_clockwait of glibc 2.30 and later): Post() takes no lock, may be called from a signal
/// handler, and enters the kernel only if a thread waits. Threads call it in their loop, never inside a stage function.
/// Any number of threads may post; one waits.
class Waiter {
 public:
  /// Initialises the semaphore. @throws std::system_error  if that fails.
  Waiter();
  /// @pre no thread waits.
  ~Waiter();
  Waiter(const Waiter&) = delete;
  Waiter& operator=(const Waiter&) = delete;

  /// Wakes the waiting thread, or lets its next wait return at once. Posts are counted: each ends one wait. @rt One
  /// system call, only if a thread waits.
  void Post() noexcept ARMCMC_NONBLOCKING;

  /// Blocks until a Post() or until a time is reached; signals do not end the wait.
  /// @param t_ns  CLOCK_MONOTONIC, ns.
  /// @return true for a Post(), false at the time. What the poster wrote before is then visible (acquire / release).
  /// @rt One system call, which blocks; no heap, no throw.
  [[nodiscard]] bool WaitUntil(Nanos t_ns) noexcept ARMCMC_NONBLOCKING;

  /// When the first Post() since the last call came, CLOCK_MONOTONIC in ns; 0 if none did. By the thread that waits:
  /// the difference to the time after the wait is the latency of the wake-up. @rt Wait-free.
  [[nodiscard]] Nanos TakePostTime() noexcept ARMCMC_NONBLOCKING {
    return first_post_ns_.exchange(0, std::memory_order_relaxed);
  }

 private:
  sem_t semaphore_;
  // Orders what the poster wrote before what the waiter reads. So does the semaphore, but ThreadSanitizer does not
  // know sem_clockwait().
  std::atomic<unsigned> posts_{0};
  std::atomic<Nanos> first_post_ns_{0};
};

}  // namespace armcmc::rt
