#include "armcmc/plant_sim/log_ring.hpp"

#include <algorithm>
#include <cstring>

namespace armcmc::plant_sim {

bool LogRing::Send(const char* channel, const void* data, int size, std::int64_t utime) noexcept {
  const std::uint64_t head = head_.load(std::memory_order_relaxed);
  const std::size_t length = std::strlen(channel);
  if (head - tail_.load(std::memory_order_acquire) >= slots_.size() || size < 0 || size > kMaxBytes ||
      length >= kMaxChannel) {
    lost_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  Slot& slot = slots_[head % slots_.size()];
  std::memcpy(slot.channel.data(), channel, length + 1);
  std::memcpy(slot.bytes.data(), data, static_cast<std::size_t>(size));
  slot.size = size;
  slot.utime = utime;
  head_.store(head + 1, std::memory_order_release);
  return true;
}

const LogRing::Slot* LogRing::Front() const noexcept {
  const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
  return tail == head_.load(std::memory_order_acquire) ? nullptr : &slots_[tail % slots_.size()];
}

void LogRing::Pop() noexcept { tail_.store(tail_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

}  // namespace armcmc::plant_sim
