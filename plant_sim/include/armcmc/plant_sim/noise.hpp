#pragma once

#include <cstdint>
#include <memory>

#include "armcmc/plant_sim/rng.hpp"
#include "armcmc/plant_sim/series.hpp"

namespace armcmc::plant_sim {

enum class NoiseKind : std::uint8_t { kNone, kGaussian, kStudentT, kLaplace, kMixture, kRecorded };
/// As scenario files call it; "none" for kNone.
[[nodiscard]] const char* NoiseKindName(NoiseKind kind) noexcept;

/// Noise of one sensor channel, zero mean.
///
///   e_k = correlation e_(k-1) + sqrt(1 - correlation^2) w_k,  e_0 = w_0,  w white by the law
///   measured = true + (1 + growth |true| / reference) e
///
/// so that the correlation does not change the standard deviation. `std` is the scale of the law in the unit of the
/// channel: the standard deviation (Gaussian), the scale of the t law, the mean absolute deviation b (Laplace), the
/// standard deviation of the narrow part (mixture), the standard deviation (recorded).
///
/// Recorded noise is that of a real sensor, a sample for a sample, from a place that is drawn: to its end and back, to
/// its beginning and forth. Round and round it would be periodic.
struct NoiseLaw {
  NoiseKind kind = NoiseKind::kNone;
  double std = 0.0;
  double dof = 4.0;                              ///< Student-t: degrees of freedom, > 0.
  double outlier_weight = 0.05;                  ///< Mixture: probability of the wide part, in (0, 0.5].
  double outlier_scale = 10.0;                   ///< Mixture: standard deviation of the wide part over `std`, > 1.
  double correlation = 0.0;                      ///< Of one sample with the next, in [0, 1).
  double growth = 0.0;                           ///< Of the noise with the size of the signal, >= 0.
  double share = 0.0;                            ///< `std` over `reference`, where it was given so; 0: it was not.
  std::shared_ptr<const Series> recording = {};  ///< Zero mean, unit variance.
  double reference = 0.0;  ///< Rms of the true channel while a mode acts, > 0 with growth or share.
};

/// One draw of w. kNone and kRecorded, which the sensors read, take nothing from the generator and return 0.
///
///   Student-t  t = sqrt(dof (u^(-2/dof) - 1)) cos(2 pi v)      (Bailey 1994, exact for any dof)
///   Laplace    by inverse CDF
[[nodiscard]] double Draw(const NoiseLaw& law, Rng* rng) noexcept;

/// Standard deviation of a noise law where the signal is zero; its scale where it has none.
[[nodiscard]] double NoiseSd(const NoiseLaw& law);

}  // namespace armcmc::plant_sim
