#pragma once

#include <netinet/in.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace armcmc::rt {

/// Longest channel name of LCM is 63 characters; the longest of ours is EST_POSTERIOR.
inline constexpr std::size_t kMaxChannelLength = 63;
/// Longest prefix of a configuration, in characters.
inline constexpr std::size_t kMaxPrefixLength = 48;

/// Channels of the estimator, without prefix.
inline constexpr char kEstimateChannel[] = "EST_ESTIMATE";
inline constexpr char kPosteriorChannel[] = "EST_POSTERIOR";
inline constexpr char kChangeChannel[] = "EST_CHANGE";
inline constexpr char kStatusChannel[] = "EST_STATUS";

/// The parts of udpm://GROUP:PORT?ttl=N&recv_buf_size=BYTES that a receiver needs.
struct LcmUrl {
  in_addr group{};                ///< Multicast group, network byte order.
  std::uint16_t port = 7667;      ///< Host byte order.
  int ttl = 0;                    ///< [0, 255]; 0 stays on this host.
  int recv_buf_size = 4'194'304;  ///< Bytes of kernel receive buffer; the default holds about 450 packs.
  std::string text;               ///< As it was given: what liblcm gets.
};

/// @throws std::invalid_argument that quotes the URL and says what is wrong with it. Missing group, port and options
///         take LCM's defaults.
[[nodiscard]] LcmUrl ParseLcmUrl(const std::string& url);

/// What to tell a user whose machine has no multicast route.
[[nodiscard]] std::string MulticastRouteRemedy(const LcmUrl& url);

/// @throws std::runtime_error with the remedy when the machine has no route to the group.
void CheckMulticastRoute(const LcmUrl& url);

}  // namespace armcmc::rt
