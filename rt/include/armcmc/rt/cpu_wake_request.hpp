#pragma once

namespace armcmc::rt {

/// Asks the kernel to keep every CPU out of the idle states that take time to leave, for as long as this lives.
///
/// Linux does so while some process holds its PM QoS device open with a bound of 0 us on the time to wake up; an idle
/// CPU then waits in a loop instead of halting. That costs power and heat. In a virtual machine it also saves the path
/// through the hypervisor, which is most of the time between an event and the thread that waits for it. Source: Linux,
/// Documentation/power/pm_qos_interface.
class CpuWakeRequest {
 public:
  /// Device of the kernel.
  static constexpr char kDevice[] = "/dev/cpu_dma_latency";

  CpuWakeRequest() = default;
  ~CpuWakeRequest();
  CpuWakeRequest(const CpuWakeRequest&) = delete;
  CpuWakeRequest& operator=(const CpuWakeRequest&) = delete;

  /// @param device  Another file, for tests.
  /// @return false with errno set when the kernel does not have the device or does not grant it.
  /// @rt Not real-time: opens and writes a file. Call it before the threads start.
  bool Hold(const char* device = kDevice) noexcept;
  /// Whether the request is in effect. @rt No system call.
  [[nodiscard]] bool held() const noexcept { return file_ >= 0; }

 private:
  int file_ = -1;
};

}  // namespace armcmc::rt
