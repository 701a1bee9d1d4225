#pragma once

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/cpu_time_meter.hpp"

namespace armcmc::rt::test {

/// Keeps the CPU until the calling thread has had so much more of it.
inline void WorkFor(Nanos cpu_time_ns) noexcept ARMCMC_NONBLOCKING {
  for (const Nanos end = ThreadCpuTime() + cpu_time_ns; ThreadCpuTime() < end;) {
  }
}

inline void PinTo(int cpu) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<unsigned>(cpu), &set);
  ASSERT_EQ(pthread_setaffinity_np(pthread_self(), sizeof set, &set), 0);
}

}  // namespace armcmc::rt::test
