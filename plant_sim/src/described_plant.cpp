#include "armcmc/plant_sim/described_plant.hpp"

#include <cstddef>

namespace armcmc::plant_sim {

int DescribedPlant::SignalAt(const std::string& signal) const {
  for (std::size_t s = 0; s < signals.size(); ++s)
    if (signals[s].name == signal) return static_cast<int>(s);
  return -1;
}

int DescribedPlant::StateAt(const std::string& state) const {
  for (std::size_t s = 0; s < states.size(); ++s)
    if (states[s].name == state) return static_cast<int>(s);
  return -1;
}

std::uint64_t SignalFingerprint(const DescribedPlant& plant) {
  std::uint64_t hash = 14695981039346656037ULL;
  const auto eat = [&hash](unsigned char byte) {
    hash ^= byte;
    hash *= 1099511628211ULL;
  };
  const auto text = [&eat](const std::string& letters) {
    for (const char letter : letters) eat(static_cast<unsigned char>(letter));
    eat(0xff);
  };
  for (const DescribedPlant::Signal& signal : plant.signals) {
    text(signal.name);
    text(signal.unit);
    text(signal.role);
  }
  text(plant.output);
  return hash;
}

}  // namespace armcmc::plant_sim
