#pragma once

#include <time.h>

#include <cerrno>
#include <cstdint>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/system_call.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// Units of time in ns. All times of this library are Nanos, 64-bit integers: they last for 292 years.
inline constexpr Nanos kNanosPerSecond = 1'000'000'000;
inline constexpr Nanos kNanosPerMilli = 1'000'000;
inline constexpr Nanos kNanosPerMicro = 1'000;

ARMCMC_TRUST_NONBLOCKING_BEGIN  // clock_gettime is served by the vDSO: no system call

    /// CLOCK_MONOTONIC, ns since an arbitrary moment, usually the start of the machine. The only clock that
    /// deadlines, releases and latencies are measured on; it is the same for all processes, so that time stamps of the
    /// plant can be compared with those of the estimator on one machine.
    /// @rt No system call (vDSO).
    [[nodiscard]] inline Nanos
    MonotonicNow() noexcept ARMCMC_NONBLOCKING {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<Nanos>(t.tv_sec) * kNanosPerSecond + static_cast<Nanos>(t.tv_nsec);
}

/// CLOCK_REALTIME, ns since 1970. For the alignment of logs, and to convert the receive stamps of the kernel; never for
/// a deadline, since it may jump.
/// @rt No system call (vDSO).
[[nodiscard]] inline Nanos RealtimeNow() noexcept ARMCMC_NONBLOCKING {
  timespec t{};
  clock_gettime(CLOCK_REALTIME, &t);
  return static_cast<Nanos>(t.tv_sec) * kNanosPerSecond + static_cast<Nanos>(t.tv_nsec);
}

ARMCMC_TRUST_NONBLOCKING_END

/// CLOCK_REALTIME in microseconds: the `utime` of LCM messages. It may jump when the clock of the machine is set.
/// @rt No system call (vDSO).
[[nodiscard]] inline std::int64_t RealtimeMicros() noexcept ARMCMC_NONBLOCKING {
  return RealtimeNow() / kNanosPerMicro;
}

/// The monotonic clock in the form that the functions of core take. Core has no clock of its own: tests pass a fake
/// one, and a replay passes none, which never reaches a deadline.
/// @code
/// engine.Adjust(pack, MonotonicNow() + 2 * kNanosPerMilli, MonotonicClock(), slot);   // at most 2 ms
/// @endcode
/// @rt No heap, no lock, no throw.
[[nodiscard]] inline ClockRef MonotonicClock() noexcept ARMCMC_NONBLOCKING {
  return {[](const void*) noexcept ARMCMC_NONBLOCKING -> Nanos { return MonotonicNow(); }, nullptr};
}

/// An absolute time as a timespec, for the system calls that take one.
/// @param t_ns  ns, >= 0: a negative time would give a negative tv_nsec, which the kernel rejects.
/// @rt No system call. O(1).
[[nodiscard]] constexpr timespec ToTimespec(Nanos t_ns) noexcept {
  return {static_cast<time_t>(t_ns / kNanosPerSecond), static_cast<long>(t_ns % kNanosPerSecond)};
}

/// Sleeps until an absolute time of CLOCK_MONOTONIC; returns at once if it has passed. Signals do not end the sleep.
/// Blocks: called by a thread between two steps, never inside one.
/// @param t_ns  CLOCK_MONOTONIC, ns, >= 0.
///
/// Not std::this_thread::sleep_until: libstdc++ 12 makes a relative sleep of it, so that a preemption between
/// the clock read and the call is added to the wake-up.
ARMCMC_TRUST_NONBLOCKING_BEGIN  // a thread waits here for its release
    inline void
    SleepUntil(Nanos t_ns) noexcept ARMCMC_NONBLOCKING {
  const timespec t = ToTimespec(t_ns);
  const SystemCall wait;
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}
ARMCMC_TRUST_NONBLOCKING_END

}  // namespace armcmc::rt
