#pragma once

#include <cstdint>

namespace armcmc::plant_sim {

/// Where encoded messages go: a bus, a log.
class MessageSink {
 public:
  virtual ~MessageSink() = default;
  /// @param utime us, CLOCK_REALTIME of the sending. @return false when the message was not taken.
  virtual bool Send(const char* channel, const void* data, int size, std::int64_t utime) noexcept = 0;
};

}  // namespace armcmc::plant_sim
