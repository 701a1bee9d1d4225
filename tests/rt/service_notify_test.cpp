#include "service_notify.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>

#include "support/paths.hpp"

namespace armcmc::app::service_notify_test {
namespace {

/// A service manager's end of the socket; sets the environment as systemd does.
class Manager {
 public:
  Manager() {
    const std::string path = dir_ / "notify";
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", path.c_str(), 1);
    setenv("WATCHDOG_USEC", "3000000", 1);
    setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  }
  ~Manager() {
    close(socket_);
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
  }
  std::string Next() const {
    char text[256];
    const ssize_t n = recv(socket_, text, sizeof text, 0);
    return n < 0 ? "" : std::string(text, static_cast<std::size_t>(n));
  }

 private:
  armcmc::test::ScratchDir dir_;
  int socket_ = -1;
};

TEST(ServiceNotify, SaysReadyAndStopping) {
  const Manager manager;
  ServiceNotify service;
  service.Ready();
  EXPECT_EQ(manager.Next().substr(0, 7), "READY=1");
  service.Stopping();
  EXPECT_EQ(manager.Next(), "STOPPING=1");
}

TEST(ServiceNotify, SendsASignOfLifeThreeTimesPerWatchdogTime) {
  const Manager manager;
  ServiceNotify service;
  EXPECT_EQ(service.interval_ns(), 1'000'000'000);
  service.Alive(10'000'000'000);
  EXPECT_EQ(manager.Next(), "WATCHDOG=1");
  service.Alive(10'900'000'000);
  EXPECT_EQ(manager.Next(), "") << "too early for another one";
  service.Alive(11'000'000'000);
  EXPECT_EQ(manager.Next(), "WATCHDOG=1");
}

TEST(ServiceNotify, AnotherProcessOfTheServiceIsNotWatched) {
  const Manager manager;
  setenv("WATCHDOG_PID", "1", 1);
  ServiceNotify service;
  service.Alive(10'000'000'000);
  EXPECT_EQ(manager.Next(), "");
}

}  // namespace
}  // namespace armcmc::app::service_notify_test
