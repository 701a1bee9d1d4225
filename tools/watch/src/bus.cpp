#include "armcmc/watch/bus.hpp"

#include <poll.h>

#include <stdexcept>
#include <utility>

#include "armcmc/rt/lcm_url.hpp"
#include "armcmc/watch/names.hpp"

namespace armcmc::watch {
namespace {

// More than a step sends, so that a slow screen loses steps as a whole and late.
constexpr int kQueue = 200;

/// The prefix as a regular expression that matches nothing else: liblcm takes channels as expressions.
std::string Quoted(const std::string& text) {
  std::string quoted;
  for (const char c : text) {
    if (std::string("\\^$.|?*+()[]{}").find(c) != std::string::npos) quoted += '\\';
    quoted += c;
  }
  return quoted;
}

}  // namespace

Bus::Bus(const std::string& url, std::string prefix, Handler handler)
    : prefix_(std::move(prefix)), handler_(std::move(handler)) {
  rt::CheckMulticastRoute(rt::ParseLcmUrl(url));
  lcm_.reset(lcm_create(url.c_str()));
  if (!lcm_) throw std::runtime_error("cannot join the bus " + url);
  for (const char* name :
       {rt::kEstimateChannel, rt::kPosteriorChannel, rt::kChangeChannel, rt::kStatusChannel, kTruthChannel}) {
    lcm_subscription_t* subscription = lcm_subscribe(lcm_.get(), (Quoted(prefix_) + name).c_str(), &OnMessage, this);
    if (subscription == nullptr) throw std::runtime_error("cannot listen on the bus " + url);
    lcm_subscription_set_queue_capacity(subscription, kQueue);
  }
  fd_ = lcm_get_fileno(lcm_.get());
  if (fd_ < 0) throw std::runtime_error("cannot listen on the bus " + url);
}

void Bus::OnMessage(const lcm_recv_buf_t* buffer, const char* channel, void* self) {
  Bus* bus = static_cast<Bus*>(self);
  const std::string name(channel);
  bus->handler_(name.substr(bus->prefix_.size()), buffer->data, static_cast<int>(buffer->data_size));
}

void Bus::Drain(int most) {
  for (int i = 0; i < most; ++i) {
    pollfd readable{fd_, POLLIN, 0};
    if (poll(&readable, 1, 0) <= 0) return;
    lcm_handle(lcm_.get());
  }
}

}  // namespace armcmc::watch
