#pragma once

#include <array>
#include <memory>
#include <vector>

#include "armcmc/mode_data.hpp"
#include "armcmc/noise_model.hpp"
#include "armcmc/parameter_space.hpp"
#include "simd/kernels.hpp"

namespace armcmc::test {

/// Log-likelihood of a tile of candidates, sample by sample.
/// @param model  Of a compiled plant; -1 for a plant file.
/// @param u      Standardised coordinates: [dimension][lane].
inline std::vector<double> ScoreEverySample(const simd::Kernels& kernels, int model, const ParameterSpace& space,
                                            const NoiseModel& noise, const ModeData& data, const double* const* u) {
  std::vector<double> out(kTileLanes);
  auto theta = std::make_unique<ThetaTile>();
  auto tile = std::make_unique<PredictionTile>();
  alignas(64) std::array<double, kTileLanes> log_scale;
  kernels.to_physical(space, u, 0, theta.get(), log_scale.data());
  kernels.predict(model, data, *theta, tile.get());
  kernels.log_likelihood(noise, data, *tile, log_scale.data(), out.data());
  return out;
}

}  // namespace armcmc::test
