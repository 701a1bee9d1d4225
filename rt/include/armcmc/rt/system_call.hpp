#pragma once

#include "armcmc/nonblocking.hpp"

#if defined(__has_feature)
#if __has_feature(realtime_sanitizer)
#include <sanitizer/rtsan_interface.h>
#define ARMCMC_RTSAN_RUNS 1
#endif
#endif

namespace armcmc::rt {

/// Marks the rest of a scope as an intended system call, on a thread on which everything else is checked to make none:
/// the wait for the next release or pack, the wake-up of another thread, reading the socket, sending a message.
///
/// In a build with RealtimeSanitizer (preset rtsan), the checks of the current thread are suspended while the object
/// lives; in other builds it does nothing. Use it in the function that makes the call, as late as possible, between
/// ARMCMC_TRUST_NONBLOCKING_BEGIN and END, which give the compile-time check the same exception:
///
///   ARMCMC_TRUST_NONBLOCKING_BEGIN
///   void Wake() noexcept ARMCMC_NONBLOCKING {
///     const SystemCall wake;
///     sem_post(&semaphore_);
///   }
///   ARMCMC_TRUST_NONBLOCKING_END
///
/// Objects nest. Source: the interface of RealtimeSanitizer, <sanitizer/rtsan_interface.h>, clang 20 and later.
/// @rt No heap, no lock, no throw; no code without the sanitizer.
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
