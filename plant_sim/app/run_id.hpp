#pragma once

#include <unistd.h>

#include <cstdint>

#include "armcmc/plant_sim/monotonic_clock.hpp"

namespace armcmc::plant_sim {

/// Differs between runs: the wall clock in ns, and the process id for two that start together.
[[nodiscard]] inline std::int64_t MakeRunId() {
  return ReadClock(CLOCK_REALTIME) ^ (static_cast<std::int64_t>(getpid()) << 40);
}

}  // namespace armcmc::plant_sim
