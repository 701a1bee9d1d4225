#pragma once

#include <cstdint>

namespace armcmc {

/// Counter-based random stream: output i is a bijective mix of key + i * golden ratio (SplitMix64; Steele,
/// Lea and Flood, OOPSLA 2014). A stream is selected by (seed, pack, purpose), so that what one pack draws
/// does not depend on how many draws another pack made.
class RandomStream {
 public:
  RandomStream() = default;
  RandomStream(std::uint64_t seed, std::uint64_t pack, std::uint64_t purpose) noexcept
      : counter_(Mix(Mix(Mix(seed) ^ pack) + kGolden * purpose)) {}

  [[nodiscard]] std::uint64_t Bits() noexcept {
    counter_ += kGolden;
    return Mix(counter_);
  }

  /// Number `index` of the stream, independent of what was drawn before.
  [[nodiscard]] static constexpr std::uint64_t At(std::uint64_t origin, std::uint64_t index) noexcept {
    return Mix(origin + kGolden * (index + 1));
  }
  [[nodiscard]] std::uint64_t origin() const noexcept { return counter_; }

  /// Uniform on the open interval (0, 1), 52 bits: (i + 1/2) / 2^52, never 0 nor 1.
  [[nodiscard]] double Uniform() noexcept { return (static_cast<double>(Bits() >> 12) + 0.5) * 0x1p-52; }

  static constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;
  static constexpr std::uint64_t Mix(std::uint64_t z) noexcept {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

 private:
  std::uint64_t counter_ = 0;
};

}  // namespace armcmc
