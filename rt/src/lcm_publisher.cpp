#include "armcmc/rt/lcm_publisher.hpp"

#include <stdexcept>

namespace armcmc::rt {

LcmPublisher::LcmPublisher(const LcmUrl& url, const std::string& prefix)
    : estimate_channel_(prefix + kEstimateChannel),
      posterior_channel_(prefix + kPosteriorChannel),
      change_channel_(prefix + kChangeChannel),
      status_channel_(prefix + kStatusChannel) {
  CheckMulticastRoute(url);  // before liblcm, whose message for this case names a random address
  lcm_.reset(lcm_create(url.text.c_str()));
  if (lcm_ == nullptr) throw std::runtime_error("liblcm cannot open " + url.text);
}

std::array<std::string, 4> LcmPublisher::Channels(const std::string& prefix) {
  return {prefix + kEstimateChannel, prefix + kPosteriorChannel, prefix + kChangeChannel, prefix + kStatusChannel};
}

}  // namespace armcmc::rt
