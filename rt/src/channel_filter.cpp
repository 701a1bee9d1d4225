#include "armcmc/rt/channel_filter.hpp"

#include <sys/socket.h>

#include <cstddef>
#include <cstdint>
#include <new>

#include "armcmc/rt/lcm_receiver.hpp"

namespace armcmc::rt {
namespace {

constexpr std::size_t kUdpHeader = 8;       // the filter of a UDP socket sees it
constexpr std::uint32_t kAll = 0xffffffff;  // bytes of a datagram that are kept

sock_filter Load(unsigned width, std::size_t offset) {
  return BPF_STMT(static_cast<std::uint16_t>(BPF_LD | width | BPF_ABS), static_cast<std::uint32_t>(offset));
}

/// Ends the comparison of this channel, which has `left` instructions after this one, unless A op k.
sock_filter Unless(unsigned op, std::uint32_t k, std::size_t left) {
  return BPF_JUMP(static_cast<std::uint16_t>(BPF_JMP | op | BPF_K), k, 0, static_cast<std::uint8_t>(left));
}

std::uint32_t BigEndian(const std::string& text, std::size_t first, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = first; i < first + count; ++i) value = value << 8U | static_cast<std::uint8_t>(text[i]);
  return value;
}

void AppendChannel(const std::string& name, std::vector<sock_filter>* program) {
  const std::string text = name + '\0';  // the end is compared, too: other names may begin in the same way
  const std::size_t words = text.size() / 4, bytes = text.size() % 4;
  // Each comparison skips the rest of this channel: two instructions for each of them, and the return.
  std::size_t left = 2 * (words + bytes + 1) + 1;
  // Loading past the end of a datagram would drop it.
  program->push_back(BPF_STMT(BPF_LD | BPF_W | BPF_LEN, 0));
  program->push_back(Unless(BPF_JGE, static_cast<std::uint32_t>(kUdpHeader + kLcmHeaderSize + text.size()), left));
  const auto compare = [&](unsigned width, std::size_t offset, std::uint32_t value) {
    left -= 2;
    program->push_back(Load(width, offset));
    program->push_back(Unless(BPF_JEQ, value, left));
  };
  compare(BPF_W, kUdpHeader, kLcmMagicShort);
  const std::size_t begin = kUdpHeader + kLcmHeaderSize;
  for (std::size_t i = 0; i < words; ++i) compare(BPF_W, begin + 4 * i, BigEndian(text, 4 * i, 4));
  for (std::size_t i = 4 * words; i < text.size(); ++i) compare(BPF_B, begin + i, BigEndian(text, i, 1));
  program->push_back(BPF_STMT(BPF_RET | BPF_K, 0));
}

}  // namespace

std::vector<sock_filter> FilterWithout(const std::vector<std::string>& channels) {
  std::vector<sock_filter> program;
  for (const std::string& channel : channels) AppendChannel(channel, &program);
  program.push_back(BPF_STMT(BPF_RET | BPF_K, kAll));
  if (program.size() > BPF_MAXINSNS) program.clear();
  return program;
}

bool DropChannels(int udp_socket, const std::vector<std::string>& channels) noexcept {
  try {
    std::vector<sock_filter> program = FilterWithout(channels);
    if (program.empty()) return false;
    const sock_fprog attached{static_cast<unsigned short>(program.size()), program.data()};
    return setsockopt(udp_socket, SOL_SOCKET, SO_ATTACH_FILTER, &attached, sizeof attached) == 0;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

}  // namespace armcmc::rt
