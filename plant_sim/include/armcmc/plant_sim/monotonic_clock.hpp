#pragma once

#include <sys/prctl.h>

#include <cstdint>
#include <ctime>

namespace armcmc::plant_sim {

inline constexpr std::int64_t kNanosPerSecond = 1'000'000'000;
/// How often, at least, code that waits for the time of a pack checks whether it has to stop.
inline constexpr std::int64_t kLongestNap = kNanosPerSecond / 10;
/// From the start of a program to sample 0: what is due first is not late because threads have just begun.
inline constexpr std::int64_t kStartDelay = kNanosPerSecond / 10;

[[nodiscard]] inline std::int64_t ReadClock(clockid_t clock) noexcept {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<std::int64_t>(t.tv_sec) * kNanosPerSecond + t.tv_nsec;
}

/// ns, CLOCK_MONOTONIC: the grid of the packs.
[[nodiscard]] inline std::int64_t MonotonicNow() noexcept { return ReadClock(CLOCK_MONOTONIC); }
/// us, CLOCK_REALTIME: the alignment of logs.
[[nodiscard]] inline std::int64_t WallClockMicros() noexcept { return ReadClock(CLOCK_REALTIME) / 1000; }

/// Sleeps until an absolute time on CLOCK_MONOTONIC; a signal may end the sleep early.
inline void SleepUntil(std::int64_t t_ns) noexcept {
  const timespec t{static_cast<time_t>(t_ns / kNanosPerSecond), static_cast<long>(t_ns % kNanosPerSecond)};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr);
}

/// This thread's sleeps end on time: without real-time priority the kernel may add 50 us, so as to wake several threads
/// at once, and a plant's samples would leave it that late.
inline void WakeOnTime() noexcept { prctl(PR_SET_TIMERSLACK, 1UL); }

}  // namespace armcmc::plant_sim
