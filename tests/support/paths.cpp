#include <arpa/inet.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <stdexcept>
#include <system_error>

#include "support/paths.hpp"

namespace armcmc::test {
namespace fs = std::filesystem;

namespace {

constexpr const char* kGroup = "239.255.76.67";
constexpr int kFirstPort = 21'000;
constexpr int kNumPorts = 2'000;

fs::path DataDir() {
  const char* dir = std::getenv("ARMCMC_DATA");
  return dir != nullptr && *dir != '\0' ? fs::path(dir) : fs::path(ARMCMC_TEST_DATA);
}

// An abstract socket name belongs to one process and vanishes with it, even when the process is killed.
int ReservePort(int port) {
  const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return -1;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = "armcmc-test-bus-" + std::to_string(port);
  name.copy(address.sun_path + 1, sizeof(address.sun_path) - 1);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  // The sockets interface takes every address through this one type.
  if (bind(fd, reinterpret_cast<const sockaddr*>(&address), size) == 0) return fd;
  close(fd);
  return -1;
}

}  // namespace

fs::path SourceDir() { return ARMCMC_SOURCE_DIR; }

fs::path Program(const std::string& name) { return fs::path(ARMCMC_PROGRAM_DIR) / name; }

std::optional<fs::path> FindData(const std::string& relative) {
  fs::path path = DataDir() / relative;
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  return path;
}

std::string DataSkipReason(const std::string& relative) {
  return "needs the recording " + (DataDir() / relative).lexically_normal().string() +
         ", which is not there; set ARMCMC_DATA to the folder that holds " + relative;
}

ScratchDir::ScratchDir() {
  std::string pattern = (fs::temp_directory_path() / "armcmc-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr)
    throw std::system_error(errno, std::generic_category(), "cannot make " + pattern);
  path_ = pattern;
}

ScratchDir::~ScratchDir() {
  std::error_code error;
  fs::remove_all(path_, error);
}

TestBus::TestBus() {
  const int start = static_cast<int>(getpid()) % kNumPorts;
  for (int i = 0; i < kNumPorts && lock_fd_ < 0; ++i) {
    const int port = kFirstPort + (start + i) % kNumPorts;
    lock_fd_ = ReservePort(port);
    url_ = std::string("udpm://") + kGroup + ":" + std::to_string(port) + "?ttl=0";
  }
  if (lock_fd_ < 0) throw std::runtime_error("no free port for a test bus");
}

TestBus::~TestBus() { close(lock_fd_); }

bool MulticastWorks() {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(kFirstPort - 1);
  inet_pton(AF_INET, kGroup, &address.sin_addr);
  // Connecting a datagram socket sends nothing; it fails when there is no route.
  const bool ok = connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(fd);
  return ok;
}

std::string MulticastSkipReason() {
  return "no multicast route; as root: ip link set lo up && ip route add 224.0.0.0/4 dev lo";
}

}  // namespace armcmc::test
