#include "armcmc/rt/snapshot_hand_over.hpp"

#include <cstring>

namespace armcmc::rt {

std::vector<std::byte> JoinParts(std::span<const std::vector<std::byte>> parts) {
  if (parts.size() == 1) return parts.front();
  std::vector<std::byte> bytes;
  for (const std::vector<std::byte>& part : parts) {
    const auto size = static_cast<std::uint32_t>(part.size());
    const auto head = std::as_bytes(std::span(&size, 1));
    bytes.insert(bytes.end(), head.begin(), head.end());
    bytes.insert(bytes.end(), part.begin(), part.end());
  }
  return bytes;
}

std::vector<std::vector<std::byte>> SplitParts(std::span<const std::byte> bytes, int count) {
  if (count == 1) return {std::vector<std::byte>(bytes.begin(), bytes.end())};
  std::vector<std::vector<std::byte>> parts;
  for (int j = 0; j < count; ++j) {
    std::uint32_t size = 0;
    if (bytes.size() < sizeof size) return {};
    std::memcpy(&size, bytes.data(), sizeof size);
    bytes = bytes.subspan(sizeof size);
    if (size > bytes.size()) return {};
    parts.emplace_back(bytes.begin(), bytes.begin() + size);
    bytes = bytes.subspan(size);
  }
  if (!bytes.empty()) return {};
  return parts;
}

}  // namespace armcmc::rt
