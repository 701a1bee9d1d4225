#include "armcmc/rt/lcm_url.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <stdexcept>
#include <string_view>

namespace armcmc::rt {
namespace {

[[noreturn]] void Fail(const std::string& url, const std::string& what) {
  throw std::invalid_argument("LCM URL \"" + url + "\": " + what +
                              "; expected for example udpm://239.255.76.67:7667?ttl=0");
}

int ParseInt(const std::string& url, std::string_view text, const char* what, int lo, int hi) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < lo || value > hi) {
    Fail(url, std::string(what) + " \"" + std::string(text) + "\" is not a number in [" + std::to_string(lo) + ", " +
                  std::to_string(hi) + "]");
  }
  return value;
}

void ParseOptions(const std::string& url, std::string_view options, LcmUrl* out) {
  while (!options.empty()) {
    const std::size_t end = options.find('&');
    const std::string_view option = options.substr(0, end);
    options = end == std::string_view::npos ? std::string_view{} : options.substr(end + 1);
    const std::size_t equals = option.find('=');
    const std::string_view key = option.substr(0, equals);
    const std::string_view value = equals == std::string_view::npos ? std::string_view{} : option.substr(equals + 1);
    if (key == "ttl") {
      out->ttl = ParseInt(url, value, "ttl", 0, 255);
    } else if (key == "recv_buf_size") {
      out->recv_buf_size = ParseInt(url, value, "recv_buf_size", 2048, 1 << 30);
    } else {
      Fail(url, "unknown option \"" + std::string(key) + "\" (known: ttl, recv_buf_size)");
    }
  }
}

}  // namespace

LcmUrl ParseLcmUrl(const std::string& url) {
  constexpr std::string_view kScheme = "udpm://";
  LcmUrl out;
  out.text = url;
  std::string_view rest = url;
  if (!rest.starts_with(kScheme)) Fail(url, "only the provider udpm:// works in real time");
  rest.remove_prefix(kScheme.size());
  const std::size_t question = rest.find('?');
  if (question != std::string_view::npos) ParseOptions(url, rest.substr(question + 1), &out);
  rest = rest.substr(0, question);

  const std::size_t colon = rest.find(':');
  std::string group(rest.substr(0, colon));
  if (group.empty()) group = "239.255.76.67";
  if (inet_pton(AF_INET, group.c_str(), &out.group) != 1 || !IN_MULTICAST(ntohl(out.group.s_addr))) {
    Fail(url, "\"" + group + "\" is not an IPv4 multicast group");
  }
  if (colon != std::string_view::npos) {
    out.port = static_cast<std::uint16_t>(ParseInt(url, rest.substr(colon + 1), "port", 1, 65535));
  }
  return out;
}

std::string MulticastRouteRemedy(const LcmUrl& url) {
  char group[INET_ADDRSTRLEN] = {};
  inet_ntop(AF_INET, &url.group, group, sizeof group);
  return std::string("no multicast route to ") + group +
         "; on a machine without a network, run as root: ip link set lo up && ip route add 224.0.0.0/4 dev lo";
}

void CheckMulticastRoute(const LcmUrl& url) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) throw std::runtime_error(std::string("cannot open a UDP socket: ") + std::strerror(errno));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(url.port);
  address.sin_addr = url.group;
  const int rc = connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  const int error = errno;
  close(fd);
  if (rc != 0) {
    throw std::runtime_error(std::string("LCM at ") + url.text + ": " + std::strerror(error) + ": " +
                             MulticastRouteRemedy(url));
  }
}

}  // namespace armcmc::rt
