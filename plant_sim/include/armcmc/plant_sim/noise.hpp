#pragma once

#include <cstdint>

#include "armcmc/plant_sim/rng.hpp"

namespace armcmc::plant_sim {

enum class NoiseKind : std::uint8_t { kNone, kGaussian, kStudentT, kLaplace, kMixture };

/// White noise of one sensor channel, zero mean.
///
/// `std` is the scale of the law in the unit of the channel: the standard deviation (Gaussian), the scale of
/// the t law, the mean absolute deviation b (Laplace), the standard deviation of the narrow part (mixture).
struct NoiseLaw {
  NoiseKind kind = NoiseKind::kNone;
  double std = 0.0;
  double dof = 4.0;              ///< Student-t: degrees of freedom, > 0.
  double outlier_weight = 0.05;  ///< Mixture: probability of the wide part, in (0, 0.5].
  double outlier_scale = 10.0;   ///< Mixture: standard deviation of the wide part over `std`, > 1.
};

/// One draw. kNone takes nothing from the generator and returns 0.
///
///   Student-t  t = sqrt(dof (u^(-2/dof) - 1)) cos(2 pi v)      (Bailey 1994, exact for any dof)
///   Laplace    by inverse CDF
[[nodiscard]] double Draw(const NoiseLaw& law, Rng* rng) noexcept;

}  // namespace armcmc::plant_sim
