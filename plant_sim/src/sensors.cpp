#include "armcmc/plant_sim/sensors.hpp"

#include <utility>

namespace armcmc::plant_sim {

Sensors::Sensors(std::vector<NoiseLaw> laws, std::uint64_t seed) : laws_(std::move(laws)) {
  for (std::size_t i = 0; i < laws_.size(); ++i) streams_.emplace_back(seed, i);
}

void Sensors::Measure(const PlantSample& truth, PlantSample* measured) noexcept {
  *measured = truth;
  const std::size_t output = laws_.size() - 1;
  for (std::size_t i = 0; i < output; ++i) measured->inputs[i] += Draw(laws_[i], &streams_[i]);
  measured->output += Draw(laws_[output], &streams_[output]);
}

}  // namespace armcmc::plant_sim
