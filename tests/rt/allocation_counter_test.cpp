#include "armcmc/rt/allocation_counter.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdlib>
#include <cstring>
#include <functional>
#include <new>
#include <string>
#include <thread>

namespace armcmc::rt::allocation_counter_test {
namespace {

/// Escapes a pointer: an allocation that nobody looks at is deleted by the optimiser.
void Escape(void* pointer) { asm volatile("" : : "g"(pointer) : "memory"); }

std::uint64_t CallsOf(const std::function<void()>& work) {
  const std::uint64_t before = ThreadHeapCalls();
  work();
  return ThreadHeapCalls() - before;
}

class AllocationCounterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!HeapCallsAreCounted()) GTEST_SKIP() << "a sanitizer owns malloc; heap calls are not counted in this build";
  }
};

TEST_F(AllocationCounterTest, SeesEveryWayToAllocateAndItsRelease) {
  const auto pair = [](void* block) {
    Escape(block);
    std::free(block);
  };
  EXPECT_EQ(CallsOf([&] { pair(std::malloc(10)); }), 2U);
  EXPECT_EQ(CallsOf([&] { pair(std::calloc(2, 10)); }), 2U);
  EXPECT_EQ(CallsOf([&] { pair(std::realloc(nullptr, 10)); }), 2U);
  EXPECT_EQ(CallsOf([&] { pair(std::aligned_alloc(64, 128)); }), 2U);
  EXPECT_EQ(CallsOf([&] { pair(memalign(64, 128)); }), 2U);
  EXPECT_EQ(CallsOf([&] { pair(valloc(128)); }), 2U);
  EXPECT_EQ(CallsOf([&] { pair(pvalloc(128)); }), 2U);
  EXPECT_EQ(CallsOf([&] {
              void* block = nullptr;
              ASSERT_EQ(posix_memalign(&block, 64, 128), 0);
              pair(block);
            }),
            2U);
  EXPECT_EQ(CallsOf([] {
              auto* value = new int(1);
              Escape(value);
              delete value;
            }),
            2U);
  EXPECT_EQ(CallsOf([] {
              auto* value = new (std::nothrow) int(1);
              Escape(value);
              delete value;
            }),
            2U);
  struct alignas(64) Wide {
    char bytes[64];
  };
  EXPECT_EQ(CallsOf([] {
              auto* value = new Wide[2];
              Escape(value);
              delete[] value;
            }),
            2U);
}

TEST_F(AllocationCounterTest, SeesWhatTheLibrariesHide) {
  EXPECT_EQ(CallsOf([] {
              char* copy = strdup("a copy on the heap");
              Escape(copy);
              std::free(copy);
            }),
            2U);
  EXPECT_EQ(CallsOf([] {
              void* block = std::malloc(10);
              Escape(block);
              block = std::realloc(block, 100'000);
              Escape(block);
              std::free(block);
            }),
            3U);
  EXPECT_GE(CallsOf([] {
              const std::string text(100, 'x');
              Escape(const_cast<char*>(text.data()));
            }),
            2U);
  EXPECT_EQ(CallsOf([] { std::free(nullptr); }), 0U) << "frees nothing";
}

TEST_F(AllocationCounterTest, CountsEachThreadForItself) {
  std::uint64_t inside = 0;
  std::thread other([&inside] {
    inside = CallsOf([] {
      auto* value = new int(1);
      Escape(value);
      delete value;
    });
  });
  other.join();
  EXPECT_EQ(inside, 2U) << "what this thread needed to start the other one is not in its count";
}

}  // namespace
}  // namespace armcmc::rt::allocation_counter_test
