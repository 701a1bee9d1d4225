#include "armcmc/rt/cpu_wake_request.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>

namespace armcmc::rt {

CpuWakeRequest::~CpuWakeRequest() {
  if (file_ >= 0) close(file_);
}

bool CpuWakeRequest::Hold(const char* device) noexcept {
  if (held()) return true;
  const int file = open(device, O_WRONLY | O_CLOEXEC);
  if (file < 0) return false;
  constexpr std::int32_t kBoundMicros = 0;
  if (write(file, &kBoundMicros, sizeof kBoundMicros) == sizeof kBoundMicros) {
    file_ = file;
    return true;
  }
  const int error = errno;
  close(file);
  errno = error;
  return false;
}

}  // namespace armcmc::rt
