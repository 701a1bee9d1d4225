#include "armcmc/plant_sim/sensors.hpp"

#include <cmath>
#include <utility>

namespace armcmc::plant_sim {

Sensors::Sensors(std::vector<NoiseLaw> laws, std::uint64_t seed) : laws_(std::move(laws)), coloured_(laws_.size()) {
  for (std::size_t i = 0; i < laws_.size(); ++i) streams_.emplace_back(seed, i);
}

double Sensors::Noise(std::size_t channel, double truth) noexcept {
  const NoiseLaw& law = laws_[channel];
  double& noise = coloured_[channel];
  const double white = Draw(law, &streams_[channel]);
  const double kept = started_ ? law.correlation : 0.0;
  noise = kept * noise + std::sqrt(1.0 - kept * kept) * white;
  return law.growth > 0.0 ? (1.0 + law.growth * std::abs(truth) / law.reference) * noise : noise;
}

void Sensors::Measure(const PlantSample& truth, PlantSample* measured) noexcept {
  *measured = truth;
  const std::size_t output = laws_.size() - 1;
  for (std::size_t i = 0; i < output; ++i) measured->inputs[i] += Noise(i, truth.inputs[i]);
  measured->output += Noise(output, truth.output);
  started_ = true;
}

}  // namespace armcmc::plant_sim
