#pragma once

#include <cstddef>

#include "armcmc/nonblocking.hpp"

namespace armcmc {

/// Asks for memory that is about to be read, so that the reader does not wait for it. Nothing else changes.
/// @param bytes  From `begin` on; a cache line is assumed to hold 64.
/// @rt No heap, no lock, no throw. O(bytes / 64); does not wait for the memory.
inline void Prefetch(const void* begin, std::size_t bytes) noexcept ARMCMC_NONBLOCKING {
  constexpr std::size_t kLine = 64;
  const auto* const at = static_cast<const char*>(begin);
  for (std::size_t offset = 0; offset < bytes; offset += kLine) __builtin_prefetch(at + offset);
}

}  // namespace armcmc
