#include "armcmc/rt/lcm_receiver.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "armcmc/rt/channel_filter.hpp"
#include "armcmc/rt/clock.hpp"
#include "armcmc/rt/system_call.hpp"

namespace armcmc::rt {
namespace {

constexpr std::uint32_t kMagicFragment = 0x4c433033;  // "LC03"

std::uint32_t ReadBe32(const std::uint8_t* p) noexcept {
  return (std::uint32_t{p[0]} << 24U) | (std::uint32_t{p[1]} << 16U) | (std::uint32_t{p[2]} << 8U) | p[3];
}

void Set(int fd, int level, int option, int value, const char* name) {
  if (setsockopt(fd, level, option, &value, sizeof value) != 0) {
    throw std::runtime_error(std::string("setsockopt ") + name + ": " + std::strerror(errno));
  }
}

/// Age of a kernel receive stamp (CLOCK_REALTIME). A step of that clock between the stamp and now must not
/// move the arrival far: the age is kept within one second.
Nanos StampAge(const timespec& stamp) noexcept {
  const Nanos stamp_ns = static_cast<Nanos>(stamp.tv_sec) * kNanosPerSecond + static_cast<Nanos>(stamp.tv_nsec);
  return std::clamp<Nanos>(RealtimeNow() - stamp_ns, 0, kNanosPerSecond);
}

}  // namespace

DatagramKind ParseDatagram(std::span<const std::uint8_t> bytes, const std::string& channel,
                           std::span<const std::uint8_t>* payload) noexcept {
  if (bytes.size() < kLcmHeaderSize) return DatagramKind::kMalformed;
  const std::uint32_t magic = ReadBe32(bytes.data());
  if (magic == kMagicFragment) return DatagramKind::kFragment;
  if (magic != kLcmMagicShort) return DatagramKind::kMalformed;
  const std::size_t name_size = channel.size() + 1;  // with its NUL
  if (bytes.size() >= kLcmHeaderSize + name_size &&
      std::memcmp(bytes.data() + kLcmHeaderSize, channel.c_str(), name_size) == 0) {
    *payload = bytes.subspan(kLcmHeaderSize + name_size);
    return DatagramKind::kOurs;
  }
  const std::size_t search = std::min(bytes.size() - kLcmHeaderSize, kMaxChannelLength + 1);
  return std::memchr(bytes.data() + kLcmHeaderSize, 0, search) != nullptr ? DatagramKind::kForeign
                                                                          : DatagramKind::kMalformed;
}

LcmReceiver::LcmReceiver(const LcmUrl& url, std::vector<std::string> channels, const std::vector<std::string>& own)
    : channels_(std::move(channels)) {
  for (const std::string& channel : channels_)
    if (channel.size() > kMaxChannelLength) {
      throw std::invalid_argument("channel \"" + channel + "\" is longer than " + std::to_string(kMaxChannelLength) +
                                  " characters");
    }
  CheckMulticastRoute(url);
  try {
    wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (wake_ < 0 || socket_ < 0) throw std::runtime_error(std::string("socket: ") + std::strerror(errno));
    Set(socket_, SOL_SOCKET, SO_REUSEADDR, 1, "SO_REUSEADDR");
    Set(socket_, IPPROTO_IP, IP_MULTICAST_ALL, 0, "IP_MULTICAST_ALL");
    Set(socket_, SOL_SOCKET, SO_TIMESTAMPNS, 1, "SO_TIMESTAMPNS");
    // The forced form needs CAP_NET_ADMIN; the plain one is cut to net.core.rmem_max without an error.
    if (setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &url.recv_buf_size, sizeof url.recv_buf_size) != 0) {
      Set(socket_, SOL_SOCKET, SO_RCVBUF, url.recv_buf_size, "SO_RCVBUF");
    }
    socklen_t size = sizeof recv_buf_size_;
    (void)getsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &recv_buf_size_, &size);

    if (!own.empty()) (void)DropChannels(socket_, own);  // refused: they are read and passed over

    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(url.port);
    address.sin_addr = url.group;
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("cannot bind " + url.text + ": " + std::strerror(errno));
    }
    ip_mreq join{};
    join.imr_multiaddr = url.group;
    join.imr_interface.s_addr = htonl(INADDR_ANY);  // the interface of the route, where liblcm publishes
    if (setsockopt(socket_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &join, sizeof join) != 0) {
      throw std::runtime_error("cannot join " + url.text + ": " + std::strerror(errno) + ": " +
                               MulticastRouteRemedy(url));
    }
  } catch (...) {
    Close();
    throw;
  }
}

LcmReceiver::~LcmReceiver() { Close(); }

void LcmReceiver::Close() noexcept {
  if (socket_ >= 0) close(socket_);
  if (wake_ >= 0) close(wake_);
  socket_ = wake_ = -1;
}

// The socket is read, and the next pack waited for, on the collect thread: system calls by nature.
ARMCMC_TRUST_NONBLOCKING_BEGIN

bool LcmReceiver::WaitUntil(Nanos t_ns) noexcept ARMCMC_NONBLOCKING {
  const SystemCall wait;
  pollfd fds[2] = {{socket_, POLLIN, 0}, {wake_, POLLIN, 0}};
  const timespec timeout = ToTimespec(std::max<Nanos>(0, t_ns - MonotonicNow()));
  if (ppoll(fds, 2, &timeout, nullptr) <= 0) return false;
  if (fds[1].revents != 0) {
    std::uint64_t count = 0;
    (void)!read(wake_, &count, sizeof count);
  }
  return fds[0].revents != 0;
}

bool LcmReceiver::ReadOne(std::size_t* size, Nanos* arrival_ns) noexcept ARMCMC_NONBLOCKING {
  const SystemCall read;
  iovec io{buffer_.data(), buffer_.size()};
  alignas(cmsghdr) std::array<char, 128> control{};
  msghdr message{};
  message.msg_iov = &io;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t n = recvmsg(socket_, &message, MSG_DONTWAIT);
  if (n < 0) return false;
  *size = static_cast<std::size_t>(n);
  *arrival_ns = MonotonicNow();
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  if (header != nullptr && header->cmsg_level == SOL_SOCKET && header->cmsg_type == SCM_TIMESTAMPNS) {
    timespec stamp{};
    std::memcpy(&stamp, CMSG_DATA(header), sizeof stamp);
    *arrival_ns -= StampAge(stamp);
  }
  return true;
}

void LcmReceiver::Wake() noexcept ARMCMC_NONBLOCKING {
  const std::uint64_t one = 1;
  const SystemCall wake_up;
  (void)!write(wake_, &one, sizeof one);
}

ARMCMC_TRUST_NONBLOCKING_END

DatagramKind LcmReceiver::Sort(std::size_t size, Datagram* datagram) const noexcept {
  DatagramKind kind = DatagramKind::kMalformed;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    kind = ParseDatagram({buffer_.data(), size}, channels_[c], &datagram->payload);
    datagram->channel = c;
    if (kind == DatagramKind::kOurs) break;
  }
  return kind;
}

bool LcmReceiver::TryReceive(Datagram* datagram) noexcept {
  for (int i = 0; i <= kMaxSkipped; ++i) {
    std::size_t size = 0;
    if (!ReadOne(&size, &datagram->arrival_ns)) return false;
    switch (Sort(size, datagram)) {
      case DatagramKind::kOurs: return true;
      case DatagramKind::kForeign: ++counts_.foreign; break;
      case DatagramKind::kFragment: ++counts_.fragments; break;
      case DatagramKind::kMalformed: ++counts_.malformed; break;
    }
  }
  return false;
}

void LcmReceiver::Drain() noexcept {
  constexpr int kSmallestCharge = 256;  // bytes of the kernel buffer that even an empty datagram takes
  std::size_t size = 0;
  Nanos arrival_ns = 0;
  for (int i = recv_buf_size_ / kSmallestCharge; i > 0 && ReadOne(&size, &arrival_ns); --i) {
  }
}

}  // namespace armcmc::rt
