#pragma once

#include <array>
#include <cstdint>

namespace armcmc::plant_sim {

/// Seeded random numbers that are the same with every compiler and standard library: xoshiro256++ 1.0
/// (Blackman & Vigna 2019), its state filled by splitmix64.
///
/// One seed gives many independent streams, so that noise on one channel does not change another's.
class Rng {
 public:
  Rng(std::uint64_t seed, std::uint64_t stream) noexcept;

  /// 64 random bits.
  [[nodiscard]] std::uint64_t Next() noexcept;
  /// Uniform in the open interval (0, 1), an odd multiple of 2^-53.
  [[nodiscard]] double Uniform() noexcept;
  /// Standard normal by Box and Muller (1958), two uniforms a draw. No state is carried from draw to draw.
  [[nodiscard]] double Normal() noexcept;

 private:
  std::array<std::uint64_t, 4> state_{};
};

}  // namespace armcmc::plant_sim
