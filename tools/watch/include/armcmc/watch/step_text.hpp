#pragma once

#include <string>

#include "armcmc/watch/watch_state.hpp"

namespace armcmc::watch {

/// One step as one line for people and grep: "pack 12  contact  K 4.01 +- 0.02  ...  3.9 of 100 ms  ...". No line end.
/// @pre there is a status.
[[nodiscard]] std::string StepLine(const WatchState& state);

/// The same as one JSON object for programs; numbers that are not known are null. No line end.
/// @pre there is a status.
[[nodiscard]] std::string StepJson(const WatchState& state);

}  // namespace armcmc::watch
