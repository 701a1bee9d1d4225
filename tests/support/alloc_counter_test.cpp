#include "support/alloc_counter.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdint>
#include <cstdlib>
#include <new>
#include <thread>

namespace armcmc::test::alloc_counter_test {
namespace {

// Escapes a pointer: at -O2 the optimiser deletes an allocation that nobody looks at, and the counter would
// look fine while it sees nothing.
void Escape(void* pointer) { asm volatile("" : : "g"(pointer) : "memory"); }

#define SKIP_WHEN_INACTIVE() \
  if (!AllocCounter::kActive) GTEST_SKIP() << kAllocCounterInactive

template <typename F>
long CountOf(F&& call) {
  const AllocCounter guard;
  call();
  return guard.count();
}

TEST(AllocCounter, SeesEveryFunctionOfTheCLibrary) {
  SKIP_WHEN_INACTIVE();
  void* p = nullptr;
  const auto release = [&p] {
    Escape(p);
    std::free(p);
    p = nullptr;
  };
  EXPECT_EQ(CountOf([&] {
              p = std::malloc(24);
              release();
            }),
            1)
      << "malloc";
  EXPECT_EQ(CountOf([&] {
              p = std::calloc(3, 8);
              release();
            }),
            1)
      << "calloc";
  EXPECT_EQ(CountOf([&] {
              p = std::realloc(nullptr, 24);
              release();
            }),
            1)
      << "realloc";
  EXPECT_EQ(CountOf([&] {
              p = memalign(64, 128);
              release();
            }),
            1)
      << "memalign";
  EXPECT_EQ(CountOf([&] {
              p = std::aligned_alloc(64, 128);
              release();
            }),
            1)
      << "aligned_alloc";
  EXPECT_EQ(CountOf([&] {
              if (posix_memalign(&p, 64, 128) != 0) p = nullptr;
              release();
            }),
            1)
      << "posix_memalign";
}

TEST(AllocCounter, SeesOperatorNew) {
  SKIP_WHEN_INACTIVE();
  struct alignas(128) Wide {
    double values[16];
  };
  EXPECT_EQ(CountOf([] {
              auto* p = new int(1);
              Escape(p);
              delete p;
            }),
            1)
      << "new";
  EXPECT_EQ(CountOf([] {
              auto* p = new int[8];
              Escape(p);
              delete[] p;
            }),
            1)
      << "new[]";
  EXPECT_EQ(CountOf([] {
              auto* p = new Wide();
              Escape(p);
              delete p;
            }),
            1)
      << "aligned new";
  EXPECT_EQ(CountOf([] {
              auto* p = new (std::nothrow) int(1);
              Escape(p);
              delete p;
            }),
            1)
      << "nothrow new";
}

TEST(AllocCounter, CountsFrees) {
  SKIP_WHEN_INACTIVE();
  void* p = std::malloc(16);
  Escape(p);
  const AllocCounter guard;
  std::free(nullptr);
  EXPECT_EQ(guard.frees(), 0);
  std::free(p);
  EXPECT_EQ(guard.frees(), 1);
}

TEST(AllocCounter, KeepsAlignment) {
  for (const std::size_t alignment : {16u, 64u, 4096u}) {
    void* p = nullptr;
    ASSERT_EQ(posix_memalign(&p, alignment, 10), 0);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(p) % alignment, 0u);
    std::free(p);
  }
}

TEST(AllocCounter, IsBlindToOtherThreads) {
  SKIP_WHEN_INACTIVE();
  long of_the_other = 0;
  std::thread other;
  const AllocCounter before_start;
  other = std::thread([&] {
    of_the_other = CountOf([] {
      auto* p = new int(1);
      Escape(p);
      delete p;
    });
  });
  const long of_starting_it = before_start.count();
  other.join();
  EXPECT_EQ(of_the_other, 1);
  EXPECT_EQ(before_start.count(), of_starting_it);
}

TEST(AllocCounter, NestedCountersCountFromTheirOwnStart) {
  SKIP_WHEN_INACTIVE();
  const AllocCounter outer;
  auto* a = new int(1);
  Escape(a);
  const AllocCounter inner;
  auto* b = new int(2);
  Escape(b);
  const long n_outer = outer.count(), n_inner = inner.count();
  delete a;
  delete b;
  EXPECT_EQ(n_outer, 2);
  EXPECT_EQ(n_inner, 1);
}

}  // namespace
}  // namespace armcmc::test::alloc_counter_test
