#include "armcmc/rt/waiter.hpp"

#include <cerrno>
#include <system_error>

#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/system_call.hpp"

namespace armcmc::rt {

Waiter::Waiter() {
  if (sem_init(&semaphore_, 0, 0) != 0) throw std::system_error(errno, std::generic_category(), "sem_init");
}

Waiter::~Waiter() { sem_destroy(&semaphore_); }

// A thread waits here between two steps, and a thread that has finished one wakes the next: outside the stages.
ARMCMC_TRUST_NONBLOCKING_BEGIN

void Waiter::Post() noexcept ARMCMC_NONBLOCKING {
  Nanos none = 0;
  first_post_ns_.compare_exchange_strong(none, MonotonicNow(), std::memory_order_relaxed);
  posts_.fetch_add(1, std::memory_order_release);
  // The only possible error is an overflow of the count, and then the waiter is awake anyway.
  const SystemCall wake_up;
  (void)sem_post(&semaphore_);
}

bool Waiter::WaitUntil(Nanos t_ns) noexcept ARMCMC_NONBLOCKING {
  const SystemCall wait;
  const timespec t = ToTimespec(t_ns);
  while (sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &t) != 0) {
    if (errno != EINTR) return false;
  }
  (void)posts_.load(std::memory_order_acquire);
  return true;
}

ARMCMC_TRUST_NONBLOCKING_END

}  // namespace armcmc::rt
