#include "armcmc/plant_sim/sensors.hpp"

#include <cmath>
#include <utility>

namespace armcmc::plant_sim {

Sensors::Sensors(std::vector<NoiseLaw> laws, std::uint64_t seed) : laws_(std::move(laws)), coloured_(laws_.size()) {
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    Rng& stream = streams_.emplace_back(seed, i);
    const bool recorded = laws_[i].kind == NoiseKind::kRecorded;
    place_.push_back(recorded ? stream.Next() % (2 * laws_[i].recording->values.size()) : 0);
  }
}

double Sensors::Noise(std::size_t channel, double truth) noexcept {
  const NoiseLaw& law = laws_[channel];
  double& noise = coloured_[channel];
  double white = Draw(law, &streams_[channel]);
  if (law.kind == NoiseKind::kRecorded) {
    const std::vector<double>& values = law.recording->values;
    std::size_t& place = place_[channel];
    white = law.std * values[place < values.size() ? place : 2 * values.size() - 1 - place];
    place = place + 1 < 2 * values.size() ? place + 1 : 0;
  }
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
