#include "armcmc/plant_sim/lcm_link.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <stdexcept>

namespace armcmc::plant_sim {
namespace {

constexpr const char* kRemedy =
    "no multicast route: as root run `ip link set lo up && ip route add 224.0.0.0/4 dev lo` "
    "(for a second host add the route on its network device instead)";

/// False when the kernel has no route to the group of a udpm URL. LCM itself reports that with a wrong address.
bool HasRoute(const std::string& url) {
  static const std::string kScheme = "udpm://";
  if (url.rfind(kScheme, 0) != 0) return true;
  const std::size_t start = kScheme.size();
  const std::string host = url.substr(start, url.find_first_of(":?", start) - start);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(7667);
  if (inet_pton(AF_INET, host.empty() ? "239.255.76.67" : host.c_str(), &address.sin_addr) != 1) return true;
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return true;
  // A datagram socket's connect only looks the route up.
  const int error = connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  close(fd);
  return error == 0;
}

void Subscribe(lcm_t* lcm, const std::string& channel, lcm_msg_handler_t handler, void* context) {
  lcm_subscription_t* subscription = lcm_subscribe(lcm, channel.c_str(), handler, context);
  if (subscription == nullptr)
    throw std::runtime_error("cannot subscribe to " + channel + ": multicast packets do not come back (firewall?)");
  lcm_subscription_set_queue_capacity(subscription, 64);
}

}  // namespace

LcmHandle OpenLcm(const std::string& url) {
  const auto known = [&url](const char* scheme) { return url.rfind(scheme, 0) == 0; };
  if (!known("udpm://") && !known("mpudpm://") && !known("tcpq://") && !known("memq://"))
    throw std::invalid_argument("LCM URL \"" + url + "\": expected one like udpm://239.255.76.67:7667?ttl=0");
  if (!HasRoute(url)) throw std::runtime_error("cannot open the bus " + url + ": " + kRemedy);
  LcmHandle lcm(lcm_create(url.c_str()));
  if (lcm == nullptr) throw std::runtime_error("cannot open the bus " + url + ": the reason of LCM is printed above");
  return lcm;
}

EstimateListener::EstimateListener(const std::string& url, const std::string& prefix, Handler* handler)
    : lcm_(OpenLcm(url)), handler_(handler) {
  Subscribe(lcm_.get(), prefix + "EST_ESTIMATE", OnEstimateBytes, this);
  Subscribe(lcm_.get(), prefix + "EST_STATUS", OnStatusBytes, this);
}

void EstimateListener::OnEstimateBytes(const lcm_recv_buf_t* buffer, const char* /*channel*/, void* self) {
  auto* listener = static_cast<EstimateListener*>(self);
  if (listener->estimate_.decode(buffer->data, 0, static_cast<int>(buffer->data_size)) < 0) {
    ++listener->undecodable_;
    return;
  }
  listener->handler_->OnEstimate(listener->estimate_);
}

void EstimateListener::OnStatusBytes(const lcm_recv_buf_t* buffer, const char* /*channel*/, void* self) {
  auto* listener = static_cast<EstimateListener*>(self);
  if (listener->status_.decode(buffer->data, 0, static_cast<int>(buffer->data_size)) < 0) {
    ++listener->undecodable_;
    return;
  }
  listener->handler_->OnStatus(listener->status_);
}

void EstimateListener::Poll(int timeout_ms) {
  pollfd waiting{lcm_get_fileno(lcm_.get()), POLLIN, 0};
  int wait_ms = timeout_ms;
  while (poll(&waiting, 1, wait_ms) > 0) {
    lcm_handle(lcm_.get());
    wait_ms = 0;
  }
}

}  // namespace armcmc::plant_sim
