#include "armcmc/rt/process_setup.hpp"

#include <alloca.h>
#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>

namespace armcmc::rt {

std::string PrivilegeRemedy() {
  return "Grant the privileges in one of these ways:\n"
         "  sudo setcap cap_sys_nice,cap_ipc_lock,cap_net_admin=ep $(command -v armcmc-estimator)\n"
         "  or, in /etc/security/limits.d/armcmc.conf (then log in again; check with `ulimit -r -l`):\n"
         "    @realtime  -  rtprio   99\n"
         "    @realtime  -  memlock  unlimited\n"
         "  or start it as root. To run without them: [rt] mode = \"best_effort\".";
}

std::string CpuWakeRemedy() {
  return "Keep them awake in one of these ways:\n"
         "  sudo install /usr/share/armcmc/deploy/60-armcmc.rules /etc/udev/rules.d/ && sudo udevadm trigger\n"
         "  (the group \"realtime\" may then ask for it), or start it as root, or put idle=poll on the kernel's line.\n"
         "To let them sleep: [rt] cpu_idle = \"sleep\".";
}

bool SetUpProcessMemory(const RtSettings& settings) {
  // One arena: each further one reserves 64 MB that mlockall would lock.
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  if (!settings.lock_memory) return false;
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return true;
  const int error = errno;
  if (settings.mode == RtMode::kEnforce) {
    throw PrivilegeError(std::string("cannot lock memory (mlockall: ") + std::strerror(error) + ").\n" +
                         PrivilegeRemedy());
  }
  return false;
}

[[gnu::noinline]] void PrefaultStack() noexcept {
  // Asked for, not computed from the requested size: thread-local storage lies on the same block.
  constexpr std::size_t kMargin = 32U << 10U;  // guard page, this frame, a signal handler
  pthread_attr_t attributes;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return;
  void* lowest = nullptr;
  std::size_t size = 0;
  const int error = pthread_attr_getstack(&attributes, &lowest, &size);
  pthread_attr_destroy(&attributes);
  const auto here = reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0));
  const auto end = reinterpret_cast<std::uintptr_t>(lowest) + kMargin;
  if (error != 0 || here <= end) return;
  const std::size_t bytes = here - end;
  const std::size_t page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  auto* stack = static_cast<volatile unsigned char*>(alloca(bytes));
  for (std::size_t i = 0; i < bytes; i += page) stack[i] = 0;
}

std::vector<int> AvailableCpus() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<int> cpus;
  if (sched_getaffinity(0, sizeof set, &set) != 0) return cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(static_cast<unsigned>(cpu), &set)) cpus.push_back(cpu);
  }
  return cpus;
}

}  // namespace armcmc::rt
