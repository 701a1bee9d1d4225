#include "armcmc/rt/spsc_ring.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <thread>

#include "armcmc/rt/event_log.hpp"

namespace armcmc::rt::spsc_ring_test {
namespace {

TEST(SpscRing, HandsElementsOnInOrderWithoutCopying) {
  SpscRing<int, 4> ring;
  int* first = ring.Claim();
  *first = 1;
  ring.Commit();
  *ring.Claim() = 2;
  ring.Commit();
  EXPECT_EQ(ring.size(), 2U);
  EXPECT_EQ(ring.Front(), first) << "the slot itself, not a copy";
  EXPECT_EQ(*ring.Front(), 1);
  ring.Pop();
  EXPECT_EQ(*ring.Front(), 2);
  ring.Pop();
  EXPECT_EQ(ring.Front(), nullptr);
}

TEST(SpscRing, RefusesAClaimWhenFullUntilOneIsPopped) {
  SpscRing<int, 4> ring;
  for (int i = 0; i < 4; ++i) {
    *ring.Claim() = i;
    ring.Commit();
  }
  EXPECT_EQ(ring.Claim(), nullptr);
  ring.Pop();
  EXPECT_NE(ring.Claim(), nullptr);
}

TEST(SpscRing, AClaimThatIsNotCommittedIsNotSeen) {
  SpscRing<int, 4> ring;
  int* slot = ring.Claim();
  EXPECT_EQ(ring.Front(), nullptr);
  EXPECT_EQ(ring.Claim(), slot);
}

TEST(SpscRing, LosesNothingBetweenTwoThreads) {
  struct Element {
    long a, b;
  };
  constexpr long kCount = 100'000;
  SpscRing<Element, 8> ring;
  std::thread producer([&ring] {
    for (long i = 0; i < kCount;) {
      Element* slot = ring.Claim();
      if (slot == nullptr) {
        std::this_thread::yield();
        continue;
      }
      *slot = {i, -i};
      ring.Commit();
      ++i;
    }
  });
  long wrong = 0;
  for (long i = 0; i < kCount;) {
    const Element* element = ring.Front();
    if (element == nullptr) {
      std::this_thread::yield();
      continue;
    }
    if (element->a != i || element->b != -i) ++wrong;
    ring.Pop();
    ++i;
  }
  producer.join();
  EXPECT_EQ(wrong, 0);
}

TEST(EventLog, CountsWhatDoesNotFitAndKeepsTheOldest) {
  EventLog log;
  for (std::int64_t i = 0; i < 300; ++i) log.Add({0, EventKind::kPacksLost, 0, i, 0});
  Event event;
  std::int64_t kept = 0;
  for (; log.Take(&event); ++kept) EXPECT_EQ(event.a, kept);
  EXPECT_GT(kept, 0);
  EXPECT_EQ(kept + log.dropped(), 300);
}

}  // namespace
}  // namespace armcmc::rt::spsc_ring_test
