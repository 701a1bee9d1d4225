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

/// Keeps the heap from returning memory and from mapping new arenas (mallopt: one arena, no trimming, no mmap), and
/// with lock_memory all pages in memory (mlockall, for present and future ones). A page fault in a stage would cost
/// tens of microseconds, one from the disk milliseconds.
/// Call it when everything is built and before the threads start. It applies to the whole process.
/// @return true when the memory is locked.
/// @throws PrivilegeError in RtMode::kEnforce when the memory cannot be locked; in other modes it returns false.
bool SetUpProcessMemory(const RtSettings& settings);

/// Touches every page that is left of the stack of the calling thread, so that deeper calls cause no page fault (not
/// for the main thread, whose stack grows). Does nothing if the stack cannot be determined. RtThread calls it.
void PrefaultStack() noexcept;

/// CPUs on which this process may run, ascending: its affinity mask. Empty if the kernel does not tell. Allocates; for
/// set-up.
[[nodiscard]] std::vector<int> AvailableCpus();

}  // namespace armcmc::rt
