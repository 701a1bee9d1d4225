#pragma once

#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <string>

#include "armcmc/plant_sim/message_sink.hpp"

namespace armcmc::plant_sim {

/// Writes messages to a log that lcm-logplayer and every LCM tool can read.
class LcmLogWriter final : public MessageSink {
 public:
  /// @throws std::runtime_error when the file cannot be written.
  explicit LcmLogWriter(const std::string& path);

  bool Send(const char* channel, const void* data, int size, std::int64_t utime) noexcept override;
  [[nodiscard]] std::int64_t errors() const noexcept { return errors_; }

 private:
  std::unique_ptr<lcm::LogFile> log_;
  std::int64_t errors_ = 0;
};

}  // namespace armcmc::plant_sim
