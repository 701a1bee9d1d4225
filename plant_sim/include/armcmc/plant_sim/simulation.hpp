#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "armcmc/plant_sim/effects/effect_chain.hpp"
#include "armcmc/plant_sim/scenario.hpp"
#include "armcmc/plant_sim/sensors.hpp"

namespace armcmc::plant_sim {

/// A scenario in motion: plant, then hidden effects, then sensors. The truth is the plant's own, without the effects.
/// Two simulations of one scenario and seed give bit-identical samples, so code that needs the samples runs one of
/// its own.
class Simulation {
 public:
  /// @throws std::invalid_argument when the plant's options contradict each other.
  Simulation(const Scenario& scenario, std::uint64_t seed);

  /// Goes to the next sample; the first call gives sample 0. False when the plant left the finite range: such
  /// a sample must not be used. @rt No heap, no lock, no throw.
  [[nodiscard]] bool Next() noexcept;

  [[nodiscard]] const PlantSample& truth() const noexcept { return truth_; }
  [[nodiscard]] const PlantSample& measured() const noexcept { return measured_; }
  [[nodiscard]] long long index() const noexcept { return index_; }  ///< Of the current sample; -1 before the first.
  [[nodiscard]] const Plant& plant() const noexcept { return *plant_; }

 private:
  std::unique_ptr<Plant> plant_;
  std::optional<EffectChain> effects_;  ///< None: what is true reaches the sensors as it is.
  Sensors sensors_;
  int num_inputs_;
  PlantSample truth_, measured_;
  long long index_ = -1;
};

}  // namespace armcmc::plant_sim
