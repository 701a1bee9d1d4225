#pragma once

#include <string>

#include "armcmc/types.hpp"

namespace armcmc::app {

/// Tells a service manager how the process does: the sd_notify protocol of systemd, datagrams to $NOTIFY_SOCKET.
/// Without that variable, and towards a manager that has gone, nothing happens. Not for a stage.
class ServiceNotify {
 public:
  /// Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID and connects.
  ServiceNotify();
  ~ServiceNotify();
  ServiceNotify(const ServiceNotify&) = delete;
  ServiceNotify& operator=(const ServiceNotify&) = delete;

  /// All stages run, the first step may come.
  void Ready();
  /// All stages are alive at now_ns. Sent three times per watchdog time; the manager restarts a process that is silent.
  void Alive(Nanos now_ns);
  void Stopping();

  [[nodiscard]] bool connected() const noexcept { return socket_ >= 0; }
  /// Time between two signs of life, 0: none is wanted.
  [[nodiscard]] Nanos interval_ns() const noexcept { return interval_ns_; }

 private:
  void Send(const std::string& text) const;

  int socket_ = -1;
  Nanos interval_ns_ = 0;
  Nanos next_ns_ = 0;
};

}  // namespace armcmc::app
