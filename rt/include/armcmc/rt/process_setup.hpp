#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "armcmc/rt/settings.hpp"

namespace armcmc::rt {

/// A privilege that RtMode::kEnforce needs is missing. The text says how to grant it.
class PrivilegeError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Instructions for this machine to grant FIFO priorities and locked memory, for error messages. Several lines.
[[nodiscard]] std::string PrivilegeRemedy();

/// Instructions for this machine to allow keeping the CPUs awake; see CpuWakeRequest. One line or more.
[[nodiscard]] std::string CpuWakeRemedy();

/// Keeps the heap from returning memory, from mapping new arenas, and (lock_memory) all pages in memory.
/// Call it when everything is built and before the threads start.
/// @return true when the memory is locked.
/// @throws PrivilegeError in RtMode::kEnforce when the memory cannot be locked.
bool SetUpProcessMemory(const RtSettings& settings);

/// Touches every page that is left of the stack of the calling thread (not for the main thread, whose stack grows).
void PrefaultStack() noexcept;

/// CPUs on which this process may run, ascending: its affinity mask.
[[nodiscard]] std::vector<int> AvailableCpus();

}  // namespace armcmc::rt
