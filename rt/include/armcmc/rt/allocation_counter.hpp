#pragma once

#include <cstdint>

#include "armcmc/nonblocking.hpp"

namespace armcmc::rt {

/// Calls of the heap (allocate, resize, release) made by the calling thread so far.
///
/// Linking the target armcmc_rt_allocation_counter replaces malloc, calloc, realloc, free, memalign, aligned_alloc,
/// posix_memalign, valloc and pvalloc by counting ones, in any build type; operator new and delete go through them.
/// Built with a sanitizer, which needs those functions itself, it counts nothing: see below.
/// @rt Lock-free.
[[nodiscard]] std::uint64_t ThreadHeapCalls() noexcept ARMCMC_NONBLOCKING;

/// false in a sanitizer build: the count is then always 0 and must not be reported as a measurement.
[[nodiscard]] bool HeapCallsAreCounted() noexcept;

}  // namespace armcmc::rt
