#include "armcmc/rt/latest_value.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>

namespace armcmc::rt::latest_value_test {
namespace {

TEST(LatestValue, HandsTheWrittenSlotOver) {
  LatestValue latest;
  const int slot = latest.write_slot();
  EXPECT_FALSE(latest.Acquire()) << "nothing was written yet";
  EXPECT_FALSE(latest.unread());
  EXPECT_FALSE(latest.Publish()) << "nothing was waiting";
  EXPECT_TRUE(latest.unread());
  EXPECT_TRUE(latest.Acquire());
  EXPECT_FALSE(latest.unread());
  EXPECT_EQ(latest.read_slot(), slot);
  EXPECT_NE(latest.write_slot(), slot);
  EXPECT_FALSE(latest.Acquire()) << "one value is read once";
}

TEST(LatestValue, SaysWhenAnUnreadValueWasReplacedAndGivesItsSlotBack) {
  LatestValue latest;
  const int first = latest.write_slot();
  EXPECT_FALSE(latest.Publish());
  const int second = latest.write_slot();
  EXPECT_TRUE(latest.Publish());
  EXPECT_EQ(latest.write_slot(), first);
  EXPECT_TRUE(latest.Acquire());
  EXPECT_EQ(latest.read_slot(), second) << "the newest wins";
}

TEST(LatestValue, NeverGivesOneSlotToBothThreads) {
  constexpr long kCount = 200'000;
  struct Value {
    long a = 0, b = 0;
  };
  std::array<Value, LatestValue::kSlots> values{};
  LatestValue latest;
  std::atomic<bool> done{false};
  long overwritten = 0;
  std::thread writer([&] {
    for (long i = 1; i <= kCount; ++i) {
      values[static_cast<std::size_t>(latest.write_slot())] = {i, -i};
      if (latest.Publish()) ++overwritten;
    }
    done.store(true);
  });
  long torn = 0, backwards = 0, last = 0, read = 0;
  while (true) {
    const bool was_done = done.load();
    if (latest.Acquire()) {
      const Value value = values[static_cast<std::size_t>(latest.read_slot())];
      if (value.a != -value.b) ++torn;
      if (value.a <= last) ++backwards;
      last = value.a;
      ++read;
    } else if (was_done) {
      break;
    }
  }
  writer.join();
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(backwards, 0);
  EXPECT_EQ(last, kCount) << "the last value is always seen";
  EXPECT_EQ(read + overwritten, kCount) << "every value is read or reported as replaced";
}

}  // namespace
}  // namespace armcmc::rt::latest_value_test
