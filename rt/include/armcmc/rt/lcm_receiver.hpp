#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "armcmc/nonblocking.hpp"
#include "armcmc/rt/lcm_url.hpp"
#include "armcmc/types.hpp"

namespace armcmc::rt {

/// First word, in network order, of an LCM message that travels in one datagram: "LC02".
inline constexpr std::uint32_t kLcmMagicShort = 0x4c433032;
/// Bytes before the name of the channel: this word and the number of the message.
inline constexpr std::size_t kLcmHeaderSize = 8;
/// Largest LCM message that travels in one datagram: channel, NUL and payload together.
inline constexpr std::size_t kMaxShortMessage = 65'499;

/// One message of a subscribed channel. Valid until the next call of the receiver.
struct Datagram {
  std::span<const std::uint8_t> payload;  ///< Starts with the 8-byte fingerprint.
  Nanos arrival_ns = 0;                   ///< CLOCK_MONOTONIC when the kernel received it.
  std::size_t channel = 0;                ///< Which one, in the order of the subscription.
};

/// What a datagram is for a receiver of one channel.
enum class DatagramKind : std::uint8_t {
  kOurs,       ///< A whole message of the channel.
  kForeign,    ///< A whole message of another channel.
  kFragment,   ///< A part of a message above kMaxShortMessage, magic number "LC03".
  kMalformed,  ///< Not of LCM's format: too short, another magic number, or a channel name without an end.
};

/// Splits a datagram of LCM's wire format: be32 "LC02", be32 message number, channel, NUL, payload.
/// @param bytes    The datagram.
/// @param channel  Whose datagrams are kOurs.
/// @param[out] payload  Set for kOurs only.
/// @rt O(length of channel).
[[nodiscard]] DatagramKind ParseDatagram(std::span<const std::uint8_t> bytes, const std::string& channel,
                                         std::span<const std::uint8_t>* payload) noexcept ARMCMC_NONBLOCKING;

/// Receives LCM channels on a UDP multicast socket of its own.
///
/// liblcm's receiver brings a thread that allocates, takes locks without priority inheritance and drops the newest
/// message when it is full. This one reads the same datagrams: no thread, no lock, no heap after
/// construction. It binds the group address, so that other groups on the same port are not heard, and joins on
/// the interface of the multicast route, as liblcm does. Messages in several fragments are counted and skipped.
/// One thread uses it; Wake() may come from any other, also from a signal handler.
class LcmReceiver {
 public:
  /// Datagrams that were read and not returned. Read them on the thread that receives.
  struct Counts {
    std::int64_t foreign = 0;    ///< Datagrams of other channels.
    std::int64_t fragments = 0;  ///< Fragments of messages above kMaxShortMessage.
    std::int64_t malformed = 0;  ///< Not LCM.
    [[nodiscard]] std::int64_t passed_over() const noexcept { return foreign + fragments + malformed; }
  };

  /// Opens the socket and joins the group.
  /// @param url       Bus; its recv_buf_size is cut to net.core.rmem_max without CAP_NET_ADMIN.
  /// @param channels  Names with prefix; Datagram::channel counts them from 0.
  /// @param own       Channels on which this process publishes. Their messages, whoever sent them, wake no thread and
  /// are not counted (DropChannels()).
  /// @throws std::invalid_argument when a name is longer than kMaxChannelLength.
  /// @throws std::runtime_error saying what to do when the machine has no multicast route, or which call failed.
  LcmReceiver(const LcmUrl& url, std::vector<std::string> channels, const std::vector<std::string>& own = {});
  ~LcmReceiver();
  LcmReceiver(const LcmReceiver&) = delete;
  LcmReceiver& operator=(const LcmReceiver&) = delete;

  /// Blocks until a datagram is there, until the time, or until Wake(). @return true when there may be a datagram.
  [[nodiscard]] bool WaitUntil(Nanos t_ns) noexcept ARMCMC_NONBLOCKING;

  /// Reads one datagram without waiting; skips at most kMaxSkipped others first.
  /// @return true when *datagram holds a message of one of the channels.
  [[nodiscard]] bool TryReceive(Datagram* datagram) noexcept ARMCMC_NONBLOCKING;

  /// Throws away what the kernel holds; at most as many datagrams as its buffer can hold. @rt System calls, bounded.
  void Drain() noexcept ARMCMC_NONBLOCKING;

  /// Ends the present wait, or the next one. @rt One system call (eventfd), which does not block.
  void Wake() noexcept ARMCMC_NONBLOCKING;

  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }
  /// Kernel receive buffer as read back, bytes (the kernel doubles what it grants).
  [[nodiscard]] int recv_buf_size() const noexcept { return recv_buf_size_; }

 private:
  static constexpr int kMaxSkipped = 64;

  void Close() noexcept;
  [[nodiscard]] bool ReadOne(std::size_t* size, Nanos* arrival_ns) noexcept ARMCMC_NONBLOCKING;

  /// Kind of the datagram in the buffer, by its channel.
  [[nodiscard]] DatagramKind Sort(std::size_t size, Datagram* datagram) const noexcept ARMCMC_NONBLOCKING;

  std::vector<std::string> channels_;
  int socket_ = -1;
  int wake_ = -1;
  int recv_buf_size_ = 0;
  Counts counts_;
  alignas(8) std::array<std::uint8_t, 65'536> buffer_{};
};

}  // namespace armcmc::rt
