#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "armcmc/estimate_t.hpp"
#include "armcmc/estimator_status_t.hpp"

namespace armcmc::test {

/// Writes everything on a bus to an LCM log, as lcm-logger does, and keeps the estimates and states of health of the
/// channels behind a prefix.
class BusRecorder {
 public:
  /// @throws std::runtime_error when the bus cannot be joined.
  BusRecorder(const std::string& url, const std::filesystem::path& log, std::string prefix = "");
  ~BusRecorder() { Stop(); }
  BusRecorder(const BusRecorder&) = delete;
  BusRecorder& operator=(const BusRecorder&) = delete;

  /// Ends the recording. The rest may be called any time.
  void Stop();
  [[nodiscard]] std::vector<estimate_t> estimates() const;
  [[nodiscard]] std::vector<estimator_status_t> statuses() const;
  /// t_last_ns of the newest pack, 0 before the first.
  [[nodiscard]] std::int64_t last_pack_ns() const;
  /// Waits until a condition on what was recorded holds. @return false after 20 s.
  [[nodiscard]] bool WaitUntil(const std::function<bool()>& condition) const;
  [[nodiscard]] bool WaitForEstimates(std::size_t count) const;

 private:
  static void OnMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel, BusRecorder* self);
  void Record(const lcm::ReceiveBuffer* buffer, const std::string& channel);

  std::string prefix_;
  lcm::LCM bus_;
  lcm::LogFile log_;
  mutable std::mutex mutex_;
  std::vector<estimate_t> estimates_;
  std::vector<estimator_status_t> statuses_;
  std::int64_t last_pack_ns_ = 0;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace armcmc::test
