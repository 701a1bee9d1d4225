#pragma once

#include <cstdint>
#include <span>

#include "armcmc/log_export/message_type.hpp"

namespace armcmc::log_export {

/// When an event came.
struct EventTime {
  std::int64_t utime = 0;  ///< us, of the logger.
  double t = 0.0;          ///< s, since the first event of the log.
};

/// Where the messages of one channel go.
class Sink {
 public:
  Sink() = default;
  virtual ~Sink() = default;
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;

  /// @pre data is a message of that type.
  virtual void Write(std::span<const std::uint8_t> data, const MessageType& type, const EventTime& time) = 0;
  /// @return rows that were written. @throws std::runtime_error when they were not.
  virtual std::int64_t Close() = 0;
};

}  // namespace armcmc::log_export
