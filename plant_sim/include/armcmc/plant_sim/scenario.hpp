#pragma once

#include <algorithm>
#include <cmath>
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
  int pack_samples = 100;           ///< N_s, in [1, 256].
  int pack_stride = 0;              ///< Samples from pack to pack, a divisor of N_s, which overlap then; 0: N_s.
  Schedule schedule{{}, {}};
  Options options{{}};
  std::uint64_t seed = 1;            ///< Of what was drawn: ranges, and the motion of a program that draws.
  std::vector<NoiseLaw> noise;       ///< One per input channel, then one of the output.
  std::vector<HiddenEffect> hidden;  ///< What the base equations lack. Empty: plant and sensors alone.

  [[nodiscard]] int stride() const noexcept { return pack_stride > 0 ? pack_stride : pack_samples; }
  /// T_s in seconds, from pack to pack.
  [[nodiscard]] double pack_period_s() const noexcept { return sample_interval_s * stride(); }
  /// What a pack spans, s.
  [[nodiscard]] double pack_span_s() const noexcept { return sample_interval_s * pack_samples; }
  /// Index of the last sample of pack k, from 1; 0 for k = 0.
  [[nodiscard]] long long last_sample(long long pack) const noexcept {
    return pack < 1 ? 0 : pack_samples + (pack - 1) * stride();
  }
  /// The same on the clock, ns after sample 0.
  [[nodiscard]] long long end_of_pack_ns(long long pack) const noexcept {
    return std::llround(pack_span_s() * 1e9) + (pack - 1) * std::llround(pack_period_s() * 1e9);
  }
  /// Whole packs in the duration.
  [[nodiscard]] long long num_packs() const noexcept {
    const auto periods = static_cast<long long>(duration_s / pack_period_s() + 1e-9);
    return std::max(0LL, periods - pack_samples / stride() + 1);
  }
  /// The plant at rest before its first sample. @throws std::invalid_argument when options contradict each other.
  [[nodiscard]] std::unique_ptr<Plant> MakePlant() const {
    return family->make({schedule, options, sample_interval_s, seed});
  }
};

}  // namespace armcmc::plant_sim
