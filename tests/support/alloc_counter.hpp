#pragma once

#include <cstdint>

namespace armcmc::test {

/// Counts the heap calls of this thread while it lives.
///
/// Linking armcmc_alloc_counter replaces malloc, calloc, realloc, free, memalign, aligned_alloc,
/// posix_memalign, valloc and pvalloc of the whole program, and with them every operator new of libstdc++.
/// Works in every build type. Other threads are not seen: each counts for itself. Counters may be nested; each counts
/// from its own start.
///
///     long n;
///     { const AllocCounter guard; status = Step(); n = guard.count(); }
///     EXPECT_EQ(n, 0);              // after the scope: the macros of GoogleTest allocate
///
/// Under a sanitizer, which owns malloc itself, nothing is counted: kActive is false and count() returns 0.
class AllocCounter {
 public:
  static const bool kActive;

  AllocCounter() noexcept;
  /// Allocations by this thread since construction.
  [[nodiscard]] long count() const noexcept;
  /// Calls of free with a non-null pointer by this thread since construction.
  [[nodiscard]] long frees() const noexcept;

 private:
  long allocations_at_start_;
  long frees_at_start_;
};

/// Allocations by this thread while it calls `run`.
template <class Run>
[[nodiscard]] long AllocationsOf(const Run& run) {
  const AllocCounter guard;
  run();
  return guard.count();
}

/// What a test should say when it skips because nothing is counted.
inline constexpr const char* kAllocCounterInactive =
    "allocations are not counted under a sanitizer, which replaces malloc itself";

}  // namespace armcmc::test
