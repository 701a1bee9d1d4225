#include "support/alloc_counter.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdlib>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ARMCMC_COUNT_ALLOCATIONS 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer) || \
    __has_feature(realtime_sanitizer)
#define ARMCMC_COUNT_ALLOCATIONS 0
#endif
#endif
#ifndef ARMCMC_COUNT_ALLOCATIONS
#define ARMCMC_COUNT_ALLOCATIONS 1
#endif

namespace armcmc::test {
namespace {

// Plain integers of the initial TLS image: reading them never allocates, not even in a new thread.
thread_local long t_allocations = 0;
thread_local long t_frees = 0;

}  // namespace

const bool AllocCounter::kActive = ARMCMC_COUNT_ALLOCATIONS != 0;

AllocCounter::AllocCounter() noexcept : allocations_at_start_(t_allocations), frees_at_start_(t_frees) {}

long AllocCounter::count() const noexcept { return t_allocations - allocations_at_start_; }

long AllocCounter::frees() const noexcept { return t_frees - frees_at_start_; }

#if ARMCMC_COUNT_ALLOCATIONS
namespace internal {
void CountAllocation() noexcept { ++t_allocations; }
void CountFree() noexcept { ++t_frees; }
}  // namespace internal
#endif

}  // namespace armcmc::test

#if ARMCMC_COUNT_ALLOCATIONS
// The names under which glibc keeps its own allocator reachable for those who replace it. Looking the
// originals up with dlsym instead would allocate before the first allocation.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* pointer, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* __libc_valloc(std::size_t size);
void* __libc_pvalloc(std::size_t size);
void __libc_free(void* pointer);

using armcmc::test::internal::CountAllocation;
using armcmc::test::internal::CountFree;

void* malloc(std::size_t size) {
  CountAllocation();
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  CountAllocation();
  return __libc_calloc(count, size);
}

void* realloc(void* pointer, std::size_t size) {
  CountAllocation();
  return __libc_realloc(pointer, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  CountAllocation();
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  CountAllocation();
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** pointer, std::size_t alignment, std::size_t size) {
  if (alignment < sizeof(void*) || (alignment & (alignment - 1)) != 0) return EINVAL;
  CountAllocation();
  void* const block = __libc_memalign(alignment, size);
  if (block == nullptr) return ENOMEM;
  *pointer = block;
  return 0;
}

void* valloc(std::size_t size) {
  CountAllocation();
  return __libc_valloc(size);
}

void* pvalloc(std::size_t size) {
  CountAllocation();
  return __libc_pvalloc(size);
}

void free(void* pointer) {
  if (pointer != nullptr) CountFree();
  __libc_free(pointer);
}
}  // extern "C"
#endif
