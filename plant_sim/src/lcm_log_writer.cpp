#include "armcmc/plant_sim/lcm_log_writer.hpp"

#include <cstdint>
#include <stdexcept>
#include <vector>

namespace armcmc::plant_sim {

LcmLogWriter::LcmLogWriter(const std::string& path) : log_(std::make_unique<lcm::LogFile>(path, "w")) {
  if (!log_->good()) throw std::runtime_error(path + ": cannot be written");
}

bool LcmLogWriter::Send(const char* channel, const void* data, int size, std::int64_t utime) noexcept {
  // The library's event has a pointer to non-const data, which it only reads.
  std::vector<std::uint8_t> bytes(static_cast<const std::uint8_t*>(data),
                                  static_cast<const std::uint8_t*>(data) + size);
  lcm::LogEvent event{};
  event.channel = channel;
  event.timestamp = utime;
  event.datalen = size;
  event.data = bytes.data();
  const bool ok = log_->writeEvent(&event) == 0;
  if (!ok) ++errors_;
  return ok;
}

}  // namespace armcmc::plant_sim
