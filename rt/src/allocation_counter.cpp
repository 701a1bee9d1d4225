#include "armcmc/rt/allocation_counter.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstddef>

#if defined(__has_feature)
#define ARMCMC_HAS_FEATURE(x) __has_feature(x)
#else
#define ARMCMC_HAS_FEATURE(x) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || ARMCMC_HAS_FEATURE(address_sanitizer) || \
    ARMCMC_HAS_FEATURE(thread_sanitizer) || ARMCMC_HAS_FEATURE(memory_sanitizer) ||                           \
    ARMCMC_HAS_FEATURE(realtime_sanitizer)
#define ARMCMC_COUNT_HEAP_CALLS 0
#else
#define ARMCMC_COUNT_HEAP_CALLS 1
#endif

namespace {
// initial-exec: the default model may itself allocate on the first access of a thread.
[[gnu::tls_model("initial-exec")]] thread_local std::uint64_t heap_calls = 0;
}  // namespace

namespace armcmc::rt {

ARMCMC_TRUST_NONBLOCKING_BEGIN  // initial-exec: reading it is one load
    std::uint64_t
    ThreadHeapCalls() noexcept ARMCMC_NONBLOCKING {
  return heap_calls;
}
ARMCMC_TRUST_NONBLOCKING_END

bool HeapCallsAreCounted() noexcept { return ARMCMC_COUNT_HEAP_CALLS != 0; }

}  // namespace armcmc::rt

#if ARMCMC_COUNT_HEAP_CALLS
// NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp,readability-identifier-naming): glibc's names
// glibc's own entry points; its headers do not declare them.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* __libc_valloc(std::size_t size);
void* __libc_pvalloc(std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) {
  ++heap_calls;
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  ++heap_calls;
  return __libc_calloc(count, size);
}

void* realloc(void* block, std::size_t size) {
  ++heap_calls;
  return __libc_realloc(block, size);
}

void free(void* block) {
  if (block != nullptr) ++heap_calls;
  __libc_free(block);
}

void* memalign(std::size_t alignment, std::size_t size) {
  ++heap_calls;
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++heap_calls;
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  ++heap_calls;
  if (alignment < sizeof(void*) || (alignment & (alignment - 1)) != 0) return EINVAL;
  void* result = __libc_memalign(alignment, size);
  if (result == nullptr) return ENOMEM;
  *block = result;
  return 0;
}

void* valloc(std::size_t size) {
  ++heap_calls;
  return __libc_valloc(size);
}

void* pvalloc(std::size_t size) {
  ++heap_calls;
  return __libc_pvalloc(size);
}
}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp,readability-identifier-naming)
#endif
