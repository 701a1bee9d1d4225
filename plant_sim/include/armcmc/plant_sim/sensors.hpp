#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "armcmc/plant_sim/noise.hpp"
#include "armcmc/plant_sim/plant.hpp"

namespace armcmc::plant_sim {

/// The sensors of a plant: what is true in, what is measured out. Each channel has its own random stream.
class Sensors {
 public:
  /// @param laws one per input channel of the family, then one of the output.
  Sensors(std::vector<NoiseLaw> laws, std::uint64_t seed);

  /// @rt No heap, no lock, no throw.
  void Measure(const PlantSample& truth, PlantSample* measured) noexcept;

 private:
  [[nodiscard]] double Noise(std::size_t channel, double truth) noexcept;

  std::vector<NoiseLaw> laws_;
  std::vector<Rng> streams_;
  std::vector<double> coloured_;    ///< e of the last sample.
  std::vector<std::size_t> place_;  ///< In a recorded noise, of the next sample, on the way there and back.
  bool started_ = false;
};

}  // namespace armcmc::plant_sim
