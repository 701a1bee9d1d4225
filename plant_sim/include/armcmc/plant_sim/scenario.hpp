#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/plant_sim/effects/hidden_effect.hpp"
#include "armcmc/plant_sim/noise.hpp"
#include "armcmc/plant_sim/options.hpp"
#include "armcmc/plant_sim/plant.hpp"
#include "armcmc/plant_sim/schedule.hpp"

namespace armcmc::plant_sim {

/// One experiment: a plant, its motion, what its parameters do, its sensors and the sampling.
struct Scenario {
  std::string name;
  const PlantFamily* family = nullptr;
  double duration_s = 20.0;
  double sample_interval_s = 1e-3;  ///< T.
  int pack_samples = 100;           ///< N_s = T_s / T, in [1, 256].
  Schedule schedule{{}, {}};
  Options options{{}};
  std::uint64_t seed = 1;            ///< Of what was drawn: ranges, and the motion of a program that draws.
  std::vector<NoiseLaw> noise;       ///< One per input channel, then one of the output.
  std::vector<HiddenEffect> hidden;  ///< What the base equations lack. Empty: plant and sensors alone.

  /// T_s in seconds.
  [[nodiscard]] double pack_period_s() const noexcept { return sample_interval_s * pack_samples; }
  /// Whole packs in the duration.
  [[nodiscard]] long long num_packs() const noexcept {
    return static_cast<long long>(duration_s / pack_period_s() + 1e-9);
  }
  /// The plant at rest before its first sample. @throws std::invalid_argument when options contradict each other.
  [[nodiscard]] std::unique_ptr<Plant> MakePlant() const {
    return family->make({schedule, options, sample_interval_s, seed});
  }
};

}  // namespace armcmc::plant_sim
