#pragma once

#include <lcm/lcm.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "armcmc/change_t.hpp"
#include "armcmc/estimate_t.hpp"
#include "armcmc/estimator_status_t.hpp"
#include "armcmc/nonblocking.hpp"
#include "armcmc/posterior_t.hpp"
#include "armcmc/rt/lcm_url.hpp"
#include "armcmc/rt/system_call.hpp"

namespace armcmc::rt {

/// Publishes the messages of one plant through liblcm.
///
/// Each message is encoded into a buffer that belongs to the publisher, so that there is no heap call after the first
/// message of each type (liblcm's own publish() would allocate each time). Sending is a blocking system call: for the
/// publish thread, never for a stage with a deadline. Used by one thread.
///
/// A message travels in one datagram, since each is smaller than kMaxShortMessage. UDP may lose it without a word;
/// receivers notice by the sequence number in it. Types, units and rates: lcm_types/README.md.
class LcmPublisher {
 public:
  /// Opens the socket.
  /// @param url     Bus, for example udpm://239.255.76.67:7667?ttl=0.
  /// @param prefix  Put before EST_ESTIMATE, EST_POSTERIOR, EST_CHANGE and EST_STATUS; may be empty.
  /// @throws std::runtime_error  with the remedy, if the machine has no multicast route; naming the URL, if liblcm
  ///   cannot open it.
  LcmPublisher(const LcmUrl& url, const std::string& prefix);

  /// Names of the four channels.
  [[nodiscard]] static std::array<std::string, 4> Channels(const std::string& prefix);

  /// Sends the estimate of a pack (parameters in the units of the plant, intervals, prediction) on EST_ESTIMATE.
  /// @param message  Complete: the publisher changes nothing in it, neither time stamps nor numbers.
  /// @return false if it could not be encoded (larger than 16 384 bytes) or sent; the caller counts that.
  /// @rt No heap, no throw. Blocks in the socket.
  [[nodiscard]] bool Publish(const estimate_t& message) noexcept ARMCMC_NONBLOCKING {
    return Send(estimate_channel_, message);
  }
  /// Marginal distributions of a pack, as densities on a grid, on EST_POSTERIOR; otherwise as above.
  /// @return as above. @rt As above.
  [[nodiscard]] bool Publish(const posterior_t& message) noexcept ARMCMC_NONBLOCKING {
    return Send(posterior_channel_, message);
  }
  /// Probabilities that the parameters persisted, drifted or changed, and drift rates in units per second, on
  /// EST_CHANGE; otherwise as above.
  /// @return as above. @rt As above.
  [[nodiscard]] bool Publish(const change_t& message) noexcept ARMCMC_NONBLOCKING {
    return Send(change_channel_, message);
  }
  /// Status (deadlines, stage times in ns, faults, degradation) on EST_STATUS; otherwise as above. It is sent in every
  /// period, with or without a pack.
  /// @return as above. @rt As above.
  [[nodiscard]] bool Publish(const estimator_status_t& message) noexcept ARMCMC_NONBLOCKING {
    return Send(status_channel_, message);
  }

 private:
  /// Closes the socket and frees what liblcm holds.
  struct Destroy {
    void operator()(lcm_t* lcm) const noexcept { lcm_destroy(lcm); }
  };

  // The publish thread is the one that sends, below every stage. encode() looks up the fingerprint in a static variable
  // that its first call computes.
  /// Encodes into buffer_ and sends. encode() returns the bytes written, or a negative number if they do not fit.
  ARMCMC_TRUST_NONBLOCKING_BEGIN
  template <typename Message>
  [[nodiscard]] bool Send(const std::string& channel, const Message& message) noexcept ARMCMC_NONBLOCKING {
    const int size = message.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
    if (size < 0) return false;
    const SystemCall send;
    return lcm_publish(lcm_.get(), channel.c_str(), buffer_.data(), static_cast<unsigned>(size)) == 0;
  }
  ARMCMC_TRUST_NONBLOCKING_END

  /// The bus; open from the constructor to the destructor.
  std::unique_ptr<lcm_t, Destroy> lcm_;
  /// Names of the channels, prefix included; at most kMaxChannelLength characters.
  std::string estimate_channel_, posterior_channel_, change_channel_, status_channel_;
  /// The encoded message; the largest type, posterior_t, fits.
  std::array<std::uint8_t, 16'384> buffer_{};
};

}  // namespace armcmc::rt
