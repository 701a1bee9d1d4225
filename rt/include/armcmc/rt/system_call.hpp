#pragma once

#include "armcmc/nonblocking.hpp"

#if defined(__has_feature)
#if __has_feature(realtime_sanitizer)
#include <sanitizer/rtsan_interface.h>
#define ARMCMC_RTSAN_RUNS 1
#endif
#endif

namespace armcmc::rt {

/// Says that the rest of the scope makes a system call on purpose, on a thread where everything else is checked to make
/// none: the wait for the next release or pack, the wake-up of another thread, reading the socket, sending a message.
///
/// For RealtimeSanitizer it is an exception as long as the object lives; without it, it is nothing. Used inside
/// ARMCMC_TRUST_NONBLOCKING_BEGIN .. END, in the function that makes the call and nowhere above it.
class [[nodiscard]] SystemCall {
 public:
#if defined(ARMCMC_RTSAN_RUNS)
  ARMCMC_TRUST_NONBLOCKING_BEGIN
  SystemCall() noexcept ARMCMC_NONBLOCKING { __rtsan_disable(); }
  ~SystemCall() ARMCMC_NONBLOCKING { __rtsan_enable(); }
  ARMCMC_TRUST_NONBLOCKING_END
#else
  SystemCall() noexcept {}  // user-provided, so that no compiler takes the object for unused
  ~SystemCall() {}
#endif
  SystemCall(const SystemCall&) = delete;
  SystemCall& operator=(const SystemCall&) = delete;
};

}  // namespace armcmc::rt
