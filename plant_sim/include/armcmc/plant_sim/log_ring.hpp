#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "armcmc/plant_sim/message_sink.hpp"

namespace armcmc::plant_sim {

/// Messages on their way from the publishing thread to whoever writes them to a file: one thread puts, one takes,
/// neither waits. A message that finds the ring full is lost to the log and counted.
class LogRing final : public MessageSink {
 public:
  static constexpr int kMaxBytes = 16'384, kMaxChannel = 64;

  struct Slot {
    std::array<char, kMaxChannel> channel;
    std::array<std::uint8_t, kMaxBytes> bytes;
    int size;
    std::int64_t utime;
  };

  explicit LogRing(int num_slots) : slots_(static_cast<std::size_t>(num_slots)) {}

  /// Producer. @rt No heap, no lock, no throw.
  bool Send(const char* channel, const void* data, int size, std::int64_t utime) noexcept override;
  /// Consumer: the oldest message, or nullptr. Valid until Pop().
  [[nodiscard]] const Slot* Front() const noexcept;
  void Pop() noexcept;
  [[nodiscard]] std::int64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  std::vector<Slot> slots_;
  std::atomic<std::uint64_t> head_{0}, tail_{0};
  std::atomic<std::int64_t> lost_{0};
};

}  // namespace armcmc::plant_sim
