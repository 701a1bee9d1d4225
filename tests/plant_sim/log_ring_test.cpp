#include "armcmc/plant_sim/log_ring.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

namespace armcmc::plant_sim::log_ring_test {
namespace {

TEST(LogRing, KeepsOrderAndCountsWhatDoesNotFit) {
  LogRing ring(2);
  EXPECT_EQ(ring.Front(), nullptr);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(ring.Send("C", &i, sizeof(i), i), i < 2);
  EXPECT_EQ(ring.lost(), 1);
  ASSERT_NE(ring.Front(), nullptr);
  EXPECT_STREQ(ring.Front()->channel.data(), "C");
  EXPECT_EQ(ring.Front()->utime, 0);
  ring.Pop();
  EXPECT_EQ(ring.Front()->utime, 1);
  ring.Pop();
  EXPECT_EQ(ring.Front(), nullptr);
}

TEST(LogRing, RefusesWhatIsTooLong) {
  LogRing ring(2);
  const std::vector<char> big(LogRing::kMaxBytes + 1);
  EXPECT_FALSE(ring.Send("C", big.data(), static_cast<int>(big.size()), 0));
  EXPECT_FALSE(ring.Send(std::string(LogRing::kMaxChannel, 'c').c_str(), big.data(), 1, 0));
  EXPECT_EQ(ring.lost(), 2);
}

TEST(LogRing, HandsEverythingFromOneThreadToAnother) {
  constexpr std::int64_t kMessages = 5'000;
  LogRing ring(8);
  std::thread producer([&ring] {
    // As long as a message can be, so that one that is shown too early is seen half written.
    std::vector<std::int64_t> words(LogRing::kMaxBytes / sizeof(std::int64_t));
    for (std::int64_t i = 0; i < kMessages;) {
      std::fill(words.begin(), words.end(), i);
      if (ring.Send("C", words.data(), LogRing::kMaxBytes, i)) ++i;
    }
  });
  int wrong = 0;
  for (std::int64_t expected = 0; expected < kMessages;) {
    const LogRing::Slot* slot = ring.Front();
    if (slot == nullptr) continue;
    std::int64_t last = -1;
    std::memcpy(&last, slot->bytes.data() + LogRing::kMaxBytes - sizeof(last), sizeof(last));
    if (last != expected || slot->utime != expected || slot->size != LogRing::kMaxBytes) ++wrong;
    ring.Pop();
    ++expected;
  }
  producer.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace armcmc::plant_sim::log_ring_test
