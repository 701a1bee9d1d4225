#include "service_notify.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace armcmc::app {
namespace {

std::string_view Environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

long Number(std::string_view text) {
  long value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

}  // namespace

ServiceNotify::ServiceNotify() {
  const std::string_view path = Environment("NOTIFY_SOCKET");
  sockaddr_un address{};
  if (path.size() < 2 || path.size() >= sizeof address.sun_path) return;
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.data(), path.size());
  if (address.sun_path[0] == '@') address.sun_path[0] = '\0';  // the abstract namespace
  socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ < 0) return;
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
  if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), size) != 0) {
    close(socket_);
    socket_ = -1;
    return;
  }
  const std::string_view pid = Environment("WATCHDOG_PID");
  if (pid.empty() || Number(pid) == getpid()) interval_ns_ = Nanos{Number(Environment("WATCHDOG_USEC"))} * 1000 / 3;
}

ServiceNotify::~ServiceNotify() {
  if (socket_ >= 0) close(socket_);
}

void ServiceNotify::Send(const std::string& text) const {
  if (socket_ >= 0) (void)!send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
}

void ServiceNotify::Ready() { Send("READY=1\nSTATUS=all stages run"); }

void ServiceNotify::Alive(Nanos now_ns) {
  if (interval_ns_ <= 0 || now_ns < next_ns_) return;
  next_ns_ = now_ns + interval_ns_;
  Send("WATCHDOG=1");
}

void ServiceNotify::Stopping() { Send("STOPPING=1"); }

}  // namespace armcmc::app
