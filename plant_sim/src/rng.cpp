#include "armcmc/plant_sim/rng.hpp"

#include <bit>
#include <cmath>
#include <numbers>

namespace armcmc::plant_sim {
namespace {

std::uint64_t SplitMix64(std::uint64_t* state) noexcept {
  std::uint64_t z = (*state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

}  // namespace

Rng::Rng(std::uint64_t seed, std::uint64_t stream) noexcept {
  // The stream is hashed before it meets the seed: (seed 1, stream 2) and (seed 2, stream 1) must not meet.
  std::uint64_t mixed_stream = stream;
  std::uint64_t state = seed ^ SplitMix64(&mixed_stream);
  for (std::uint64_t& word : state_) word = SplitMix64(&state);
}

std::uint64_t Rng::Next() noexcept {
  const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
  const std::uint64_t t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Rng::Uniform() noexcept {
  // The middles of 2^52 equal cells: never 0 and never 1, so that the logarithms below stay finite.
  return (static_cast<double>(Next() >> 12) + 0.5) * 0x1.0p-52;
}

double Rng::Normal() noexcept {
  const double radius = std::sqrt(-2.0 * std::log(Uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * Uniform());
}

}  // namespace armcmc::plant_sim
